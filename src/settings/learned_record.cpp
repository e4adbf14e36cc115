#include "settings/learned_record.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "canopen/sdo_abort.hpp"

namespace servoctl::settings {
namespace {

std::string reason_text(std::uint32_t code) {
  switch (code) {
    case session::kWasSilent: return "no answer";
    case session::kAnsweredWrongly: return "no proper answer, or longer than 64 KiB";
    case session::kRaisedAlarm: return "not read: an EMCY came while this and its neighbours were read";
    default: return canopen::sdo_abort_text(code);
  }
}

report::Table left_out_table(const Learned& learned) {
  report::Table table;
  table.columns = {{"object", "", report::Show::text},
                   {"index", "", report::Show::json},
                   {"sub", "", report::Show::json},
                   {"reason", "why"}};
  for (const auto& each : learned.left_out)
    table.rows.push_back(
        {to_string(each.object), each.object.index, each.object.sub, reason_text(each.abort_code)});
  return table;
}

}  // namespace

report::Record learned_record(const Learned& learned, const od::EdsFile& sheet, std::uint8_t node,
                              const std::filesystem::path& file) {
  std::size_t write_only = 0;
  for (const auto& object : sheet.dictionary.objects())
    write_only += static_cast<std::size_t>(
        std::count_if(object.entries.begin(), object.entries.end(),
                      [](const od::Entry& entry) { return !od::readable(entry.access); }));
  return {{"node", node},
          {"file", file.string()},
          {"source", learned.source},
          {"objects", sheet.dictionary.objects().size()},
          {"entries", sheet.dictionary.entry_count()},
          {"write_only", write_only, report::Show::everywhere, "can only be written"},
          {"ranges", learned.ranges.empty() ? report::Value() : report::Value(learned.ranges),
           report::Show::everywhere, "indexes read"},
          {"resumed", learned.resumed, report::Show::json},
          {"left_out", left_out_table(learned), report::Show::json},
          {"left_out", learned.left_out.empty() ? report::Value() : report::Value(left_out_table(learned)),
           report::Show::text, "not readable, left out"}};
}

}  // namespace servoctl::settings
