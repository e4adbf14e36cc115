#include "show/known_drive.hpp"

#include "base/file.hpp"
#include "base/format.hpp"
#include "base/found_file.hpp"
#include "show/bus_name.hpp"
#include "show/field_reader.hpp"
#include "show/identity.hpp"

namespace servoctl::show {
namespace {

constexpr std::uint64_t kVersion = 1;
constexpr std::uintmax_t kMostBytes = 1U << 16U;

tl::unexpected<Error> damaged(Message message) {
  return fail(Errc::file, std::move(message),
              "delete the file; it only remembers what -d was for this drive");
}

}  // namespace

KnownDriveFile::KnownDriveFile(const std::filesystem::path& state_folder, std::string_view bus_url,
                               std::uint8_t node)
    : node_(node), path_(state_folder / formatted("drive-{}-node-{}.json", bus_name(bus_url), node)) {}

Result<std::optional<KnownDrive>> KnownDriveFile::read() const {
  std::error_code error;
  if (!std::filesystem::exists(std::filesystem::symlink_status(path_, error)))
    return std::optional<KnownDrive>();
  const auto text = read_file(path_, kMostBytes);
  if (!text) return fail(text.error());
  const auto document = report::parse_json(*text, path_.string());
  if (!document) return damaged(document.error().message);
  FieldReader fields(*document, as_it_is(path_.string()));
  KnownDrive out;
  if (fields.number("servoctl_drive", true).value_or(kVersion) != kVersion) fields.refuse("servoctl_drive");
  if (fields.number("node", true).value_or(node_) != node_) fields.refuse("node");
  out.family = fields.text("family", true);
  out.turn = fields.text("turn");
  out.time = fields.text("time", true);
  const auto* inside = report::find(*document, "identity");
  auto identity = inside == nullptr ? std::nullopt : identity_of(*inside, node_);
  if (!identity) fields.refuse("identity");
  if (fields.error()) return damaged(*fields.error());
  out.identity = std::move(*identity);
  return std::optional(std::move(out));
}

Result<void> KnownDriveFile::write(const KnownDrive& drive) const {
  const report::Record document{
      {"servoctl_drive", kVersion}, {"node", std::uint64_t{node_}},
      {"family", drive.family},     {"turn", report::text_or_null(drive.turn)},
      {"time", drive.time},         {"identity", identity_record(lasting(drive.identity))}};
  return write_own_file(path_, report::to_json(document) + "\n");
}

Result<void> KnownDriveFile::remove() const {
  std::error_code error;
  std::filesystem::remove(path_, error);
  if (error) return fail(Errc::file, message("{}: {}", as_it_is(path_.string()), error.message()));
  return {};
}

}  // namespace servoctl::show
