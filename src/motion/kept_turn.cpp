#include "motion/kept_turn.hpp"

#include "base/checksum.hpp"
#include "base/file.hpp"
#include "base/format.hpp"
#include "base/found_file.hpp"
#include "base/number.hpp"
#include "session/identify.hpp"
#include "show/bus_name.hpp"
#include "show/field_reader.hpp"
#include "show/identity.hpp"
#include "show/known_drive.hpp"

namespace servoctl::motion {
namespace {

using report::Record;
using report::Value;

constexpr std::uint64_t kVersion = 1;
constexpr std::uintmax_t kMostBytes = 1U << 16U;
/// More than any encoder has.
constexpr std::uint64_t kMostCounts = std::uint64_t{1} << 40U;

Record body_of(const KeptTurn& turn, std::uint8_t node) {
  return {{"servoctl_turn", kVersion},
          {"node", std::uint64_t{node}},
          {"family", turn.family},
          {"identity", show::identity_record(show::lasting(turn.identity))},
          {"counts", turn.counts},
          {"measured", turn.measured},
          {"uncertainty_ppm", turn.uncertainty_ppm},
          {"reason", turn.reason},
          {"time", turn.time}};
}

std::string seal_of(const KeptTurn& turn, std::uint8_t node) {
  return checksum_of(report::to_json(body_of(turn, node)));
}

tl::unexpected<Error> damaged(Message message) {
  return fail(Errc::file, std::move(message),
              "`units learn` measures again, `units forget` deletes the file");
}

Result<KeptTurn> parse(const Value& document, const std::string& file, std::uint8_t node) {
  show::FieldReader fields(document, as_it_is(file));
  KeptTurn out;
  if (fields.number("servoctl_turn", true).value_or(kVersion) != kVersion) fields.refuse("servoctl_turn");
  if (fields.number("node", true).value_or(node) != node) fields.refuse("node");
  out.family = fields.text("family", true);
  out.counts = fields.number("counts", true).value_or(0);
  out.measured = fields.number("measured", true).value_or(0);
  out.uncertainty_ppm = fields.number("uncertainty_ppm", true).value_or(0);
  out.reason = fields.text("reason", true);
  out.time = fields.text("time", true);
  if (out.counts < 2 || out.counts > kMostCounts) fields.refuse("counts");
  const auto* inside = report::find(document, "identity");
  const auto identity = inside == nullptr ? std::nullopt : show::identity_of(*inside, node);
  if (!identity) fields.refuse("identity");
  const auto seal = fields.text("seal", true);
  if (fields.error()) return damaged(*fields.error());
  out.identity = *identity;
  if (seal != seal_of(out, node))
    return damaged(
        message("{}: its seal does not match: the file was changed after it was written", as_it_is(file)));
  return out;
}

/// Why what is kept is not to be used; empty when it is.
std::string reason_against(const show::Desk& desk, std::uint8_t node, const KeptTurn& kept) {
  if (kept.family != desk.profile->family) return formatted("they were measured with -d {}", kept.family);
  const auto now = session::read_identity(*desk.session, node);
  if (!now) return now.error().message.text();
  const auto change = show::change_of(kept.identity, *now);
  return change.empty() ? change : change + " is not the one of the drive that was measured";
}

}  // namespace

TurnFile::TurnFile(const show::Desk& desk, std::uint8_t node) : node_(node) {
  if (!desk.state_folder.empty())
    path_ = desk.state_folder / formatted("turn-{}-node-{}.json", show::bus_name(desk.session->url()), node);
}

Result<std::optional<KeptTurn>> TurnFile::read() const {
  std::error_code error;
  if (path_.empty() || !std::filesystem::exists(std::filesystem::symlink_status(path_, error)))
    return std::optional<KeptTurn>();
  const auto text = read_file(path_, kMostBytes);
  if (!text) return fail(text.error());
  const auto document = report::parse_json(*text, path_.string());
  if (!document) return damaged(document.error().message);
  auto turn = parse(*document, path_.string(), node_);
  if (!turn) return fail(turn.error());
  return std::optional(std::move(*turn));
}

Result<void> TurnFile::write(const KeptTurn& turn) const {
  auto document = body_of(turn, node_);
  document.push_back({"seal", seal_of(turn, node_)});
  return write_own_file(path_, report::to_json(document) + "\n");
}

Result<bool> TurnFile::remove() const {
  if (path_.empty()) return false;
  std::error_code error;
  const bool removed = std::filesystem::remove(path_, error);
  if (error) return fail(Errc::file, message("{}: {}", as_it_is(path_.string()), error.message()));
  return removed;
}

namespace {

/// What --turn was for this very drive, in a line that worked.
std::optional<double> told_earlier(const show::Desk& desk, std::uint8_t node) {
  if (desk.state_folder.empty()) return std::nullopt;
  const auto said = show::KnownDriveFile(desk.state_folder, desk.session->url(), node).read();
  if (!said || !*said || (*said)->family != desk.profile->family) return std::nullopt;
  const auto turn = parse_digits((*said)->turn, 10);
  if (!turn || *turn < 2) return std::nullopt;
  const auto now = session::read_identity(*desk.session, node);
  if (!now || !show::change_of((*said)->identity, *now).empty()) return std::nullopt;
  return static_cast<double>(*turn);
}

}  // namespace

KnownTurn find_turn(const show::Desk& desk, std::uint8_t node) {
  KnownTurn out;
  if (desk.profile == nullptr) return out;
  out.told_earlier = told_earlier(desk, node);
  if (desk.profile->rules.learn.speed.empty()) return out;
  const auto kept = TurnFile(desk, node).read();
  if (!kept) out.unused = kept.error().message.text();
  if (!kept || !*kept) return out;
  out.kept = **kept;
  out.unused = reason_against(desk, node, *out.kept);
  if (out.unused.empty()) out.counts = static_cast<double>(out.kept->counts);
  return out;
}

std::string restart_note(const drive::Profile& profile, const drive::Quotient& way) {
  std::string out;
  for (const auto object : way.objects()) {
    const auto target = drive::target_at(&profile, object);
    if (drive::meaning(target, 0).effect != od::Effect::restart) continue;
    out += (out.empty() ? "" : ", ") + (target.parameter ? target.parameter->id : to_string(object));
  }
  if (out.empty()) return out;
  return formatted("{} take effect at a restart of the drive: restart it first if one was changed", out);
}

std::vector<std::string> turn_notes(const MotionUnits& units, const KnownTurn& known) {
  std::vector<std::string> out;
  const auto* way = units.turn_way();
  const auto pending = way == nullptr || way->learned ? std::string() : restart_note(units.profile(), *way);
  if (!pending.empty())
    out.push_back(formatted("{} increments of 6064h per revolution, from the drive's parameters; {}",
                            plain_number(units.turn().value_or(0), 12), pending));
  if (units.uses_learned() && known.kept)
    out.push_back(formatted(
        "{} increments of 6064h per revolution, from the {} encoder counts ({}) measured at {} and kept for "
        "this drive; --turn overrides it{}",
        plain_number(units.turn().value_or(0), 12), known.kept->counts, known.kept->reason, known.kept->time,
        known.kept->identity.serial.value_or(0) == 0
            ? "; the drive has no serial number (1018h:04), so its identity would not show an exchanged "
              "drive or motor"
            : ""));
  if (!known.unused.empty() && !units.turn())
    out.push_back(formatted("the kept counts per revolution are not used: {}; `units learn` measures again",
                            known.unused));
  return out;
}

}  // namespace servoctl::motion
