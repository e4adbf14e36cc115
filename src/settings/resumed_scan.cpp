#include "settings/resumed_scan.hpp"

#include <string>
#include <system_error>

#include "base/file.hpp"
#include "base/format.hpp"
#include "settings/scan_file.hpp"
#include "settings/scan_ranges.hpp"

namespace servoctl::settings {
namespace {

Result<bool> refuse_scan(Message what) {
  return fail(Errc::refused, std::move(what),
              "delete that file to scan from the beginning, or name another file");
}

}  // namespace

Result<bool> resume_scan(show::Desk& desk, const std::filesystem::path& kept_in,
                         const session::Identity& identity, session::ScanState& state) {
  std::error_code error;
  if (!std::filesystem::exists(kept_in, error)) return false;
  const auto text = read_file(kept_in);
  if (!text) return fail(text.error());
  if (!is_scan_file(*text))
    return refuse_scan(message("{} is no scan of servoctl", as_it_is(kept_in.string())));
  const auto start_again = [&](std::string_view why) {
    desk.notices.push_back(
        message("{}: {}; the scan starts again, and replaces it", as_it_is(kept_in.string()), why));
    return false;
  };
  auto kept = read_scan(*text);
  if (!kept) return start_again("it is damaged, or of another version");
  if (kept->identity != identity_text(desk.session->url(), identity))
    return refuse_scan(
        message("{} keeps the scan of another drive, node or bus", as_it_is(kept_in.string())));
  if (is_one_of_many(identity))
    return start_again("the drive has no serial number that tells it from others of its kind (1018h)");
  if (kept->state.ranges != state.ranges)
    return refuse_scan(message("{} keeps a scan of {}", as_it_is(kept_in.string()),
                               as_it_is(ranges_text(kept->state.ranges))));
  state = std::move(kept->state);
  desk.notices.push_back(message("the scan that {} keeps goes on at {} of {} indexes",
                                 as_it_is(kept_in.string()), state.done, state.indexes()));
  return true;
}

}  // namespace servoctl::settings
