#include "traffic/replay_plan.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "base/format.hpp"
#include "canopen/cob_id.hpp"
#include "canopen/lss.hpp"
#include "canopen/nmt.hpp"
#include "canopen/sdo_observer.hpp"
#include "drive/standard_objects.hpp"
#include "session/pdo_setup.hpp"
#include "traffic/frame_decoder.hpp"

namespace servoctl::traffic {
namespace {

using canopen::PdoDirection;

/// What programs a drive (CiA 302-3, 1F50h to 1F57h).
constexpr std::uint16_t kFirstProgram = 0x1F50;
constexpr std::uint16_t kLastProgram = 0x1F57;
constexpr std::uint16_t kFirstVendorObject = 0x2000;
constexpr std::size_t kMostKinds = 6;

bool is_of_canopen(const can::Frame& frame) { return !frame.error && !frame.extended; }

/// Every node-ID the CAN-IDs of the recording speak of, by the pre-defined connection set.
std::set<std::uint8_t> nodes_in(std::string_view recording, std::string_view channel,
                                const can::ReadOptions& read) {
  std::set<std::uint8_t> out;
  const auto note = [&](const can::LogFrame& line) {
    const auto& frame = line.frame;
    if (!is_of_canopen(frame) || frame.id > canopen::kErrorControl + canopen::kLastNode) return true;
    const auto nmt = canopen::parse_nmt(frame);
    const auto node = nmt ? nmt->node : static_cast<std::uint8_t>(frame.id & canopen::kLastNode);
    if (node >= canopen::kFirstNode && node <= canopen::kLastNode) out.insert(node);
    return true;
  };
  (void)for_each_frame_of(recording, channel, note, read);
  return out;
}

/// One choice of frames; sees all of the recording, for what PDOs carry is learnt on the way.
class Choice {
 public:
  Choice(const show::Desk& desk, const ReplayChoice& choice, const ReplayDrives& drives)
      : profile_(desk.profile),
        drives_(&drives),
        only_(choice.only),
        master_(choice.of_master),
        decoder_({desk.profile, desk.standard, false, false}) {
    for (const auto& [node, values] : drives.pdos) decoder_.pdos().set(node, values);
  }

  void add(const can::LogFrame& line) {
    ++plan_.seen;
    const auto& frame = line.frame;
    const auto& decoded = decoder_.decode(frame);
    const auto* view = decoded.service == "pdo" ? decoder_.pdos().find(frame.id) : nullptr;
    const auto write = written_object(frame, decoded);
    if (!only_.empty() && std::find(only_.begin(), only_.end(), decoded.service) == only_.end()) return;
    if (master_ && !is_of_master(frame, decoded, view)) {
      if (decoded.service == "pdo" && !frame.remote && view == nullptr) plan_.dropped.insert(frame.id);
      return;
    }
    ++plan_.services[decoded.service];
    plan_.frames.push_back(line);
    if (frame.remote) return;
    if (const auto kind = moving_kind(frame, decoded, view, write); !kind.empty()) {
      ++plan_.moving[kind];
      add_nodes(frame, decoded, view);
    }
    if (const auto kind = lasting_kind(frame, decoded, write); !kind.empty()) ++plan_.lasting[kind];
  }

  ReplayPlan take() && { return std::move(plan_); }

 private:
  /// The object of a write, with the frame that begins it.
  std::optional<ObjectAddress> written_object(const can::Frame& frame, const DecodedFrame& decoded) {
    if (decoded.service != "sdo" || !decoded.node || frame.remote) return std::nullopt;
    auto& channel = channels_[*decoded.node];
    if (frame.id < canopen::kSdoRequest) {
      (void)channel.on_server_frame(frame);
      return std::nullopt;
    }
    const auto step = channel.on_client_frame(frame);
    return step.kind == canopen::SdoStep::Kind::write ? step.object : std::nullopt;
  }

  /// Whether only a master sends it (CiA 301, 7.3.5; CiA 305).
  bool is_of_master(const can::Frame& frame, const DecodedFrame& decoded, const show::PdoView* view) const {
    if (decoded.service == "nmt" || decoded.service == "sync" || decoded.service == "time" ||
        decoded.service == "guarding" || frame.id == canopen::kLssRequest)
      return true;
    if (decoded.service == "sdo") return frame.id > canopen::kSdoRequest;
    if (decoded.service != "pdo") return false;
    if (view != nullptr) return view->pdo.direction == PdoDirection::receive;
    return drives_->listen.count(frame.id) > 0 || !looks_like_tpdo(frame);
  }

  /// By the pre-defined connection set (CiA 301, 7.3.5).
  static bool looks_like_tpdo(const can::Frame& frame) { return (frame.id & 0x80U) != 0; }

  std::string moving_kind(const can::Frame& frame, const DecodedFrame& decoded, const show::PdoView* view,
                          std::optional<ObjectAddress> write) const {
    if (decoded.service == "nmt") {
      const auto message = canopen::parse_nmt(frame);
      return message && message->command == canopen::NmtCommand::start ? "NMT start" : "";
    }
    if (decoded.service == "sync") return "SYNC";
    if (decoded.service == "pdo") {
      if (drives_->listen.count(frame.id) > 0) return "RPDO";
      if (view != nullptr) return view->pdo.direction == PdoDirection::receive ? "RPDO" : "";
      if (!looks_like_tpdo(frame)) return "RPDO";
      return drives_->pdos.empty() ? "PDO of unknown direction" : "";
    }
    return write && can_move(*write) ? formatted("write of {}", name_of(*write)) : "";
  }

  bool can_move(ObjectAddress object) const {
    if (object.index < kFirstVendorObject) return false;
    return profile_ == nullptr ||
           drive::meaning(drive::target_at(profile_, object), 0).effect != od::Effect::restart;
  }

  std::string lasting_kind(const can::Frame& frame, const DecodedFrame& decoded,
                           std::optional<ObjectAddress> write) const {
    if (frame.id == canopen::kLssRequest) return "LSS command";
    if (decoded.service == "nmt") {
      const auto message = canopen::parse_nmt(frame);
      const bool reset = message && (message->command == canopen::NmtCommand::reset_node ||
                                     message->command == canopen::NmtCommand::reset_communication);
      return reset ? formatted("NMT {}", canopen::name(message->command)) : "";
    }
    if (!write || !lasts(*write)) return "";
    const bool stores = write->index == objects::kStoreIndex;
    return formatted(fmt::runtime(stores ? "store by {}" : "write of {}"), name_of(*write));
  }

  bool lasts(ObjectAddress object) const {
    if (object.index == objects::kStoreIndex || object.index == objects::kRestoreIndex ||
        (object.index >= kFirstProgram && object.index <= kLastProgram))
      return true;
    if (profile_ == nullptr) return false;
    const auto target = drive::target_at(profile_, object);
    if ((target.entry != nullptr && target.entry->command) ||
        (target.parameter != nullptr && target.parameter->command))
      return true;
    const auto& rules = profile_->rules;
    const auto is = [&](const std::string& name) {
      const auto found = name.empty() ? fail(Errc::usage, {}) : drive::resolve(profile_, name);
      return found && found->address == object;
    };
    const auto sets = [&](const drive::Setting& setting) { return is(setting.name); };
    return is(rules.nmt.node_id) || is(rules.nmt.bitrate) || is(rules.store.flash_switch) ||
           is(rules.store.restore_at_start) ||
           std::any_of(rules.store.store.begin(), rules.store.store.end(), sets) ||
           std::any_of(rules.store.restore.begin(), rules.store.restore.end(), sets);
  }

  std::string name_of(ObjectAddress object) const { return drive::target_at(profile_, object).in_sentence(); }

  /// Whom a frame that can move reaches; NMT to all and SYNC reach everyone.
  void add_nodes(const can::Frame& frame, const DecodedFrame& decoded, const show::PdoView* view) {
    const auto listening = drives_->listen.find(frame.id);
    if (listening != drives_->listen.end())
      plan_.nodes.insert(listening->second.begin(), listening->second.end());
    else if (view != nullptr)
      plan_.nodes.insert(view->node);
    else if (decoded.node)
      plan_.nodes.insert(*decoded.node);
    else
      plan_.nodes.insert(drives_->present.begin(), drives_->present.end());
  }

  const drive::Profile* profile_;
  const ReplayDrives* drives_;
  std::span<const std::string> only_;
  bool master_;
  FrameDecoder decoder_;
  std::array<canopen::SdoObserver, 128> channels_;
  ReplayPlan plan_;
};

}  // namespace

std::size_t ReplayPlan::dangerous() const {
  return std::accumulate(moving.begin(), moving.end(), std::size_t{0},
                         [](std::size_t sum, const auto& kind) { return sum + kind.second; });
}

Result<ReplayDrives> find_drives(show::Desk& desk, std::string_view recording, std::string_view channel,
                                 const can::ReadOptions& read_as) {
  ReplayDrives out;
  std::vector<session::SdoRequest> questions;
  for (const auto node : nodes_in(recording, channel, read_as))
    questions.push_back({.node = node, .object = objects::kStatusword});
  const auto answers = desk.session->transfer(questions);
  std::vector<std::uint8_t> present;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const auto code = answers[i] ? Errc::sdo_abort : answers[i].error().code;
    if (code == Errc::bus || code == Errc::interrupted) return fail(answers[i].error());
    if (code == Errc::sdo_abort) present.push_back(questions[i].node);
  }
  out.present.insert(present.begin(), present.end());
  const auto read = session::read_pdo_values(*desk.session, desk.profile, present);
  for (std::size_t i = 0; i < read.size(); ++i) {
    if (!read[i] && (read[i].error().code == Errc::bus || read[i].error().code == Errc::interrupted))
      return fail(read[i].error());
    if (!read[i]) continue;
    out.pdos.emplace(present[i], *read[i]);
    for (const auto& pdo : session::pdos_of(*read[i]))
      if (pdo.is_valid() && pdo.direction == PdoDirection::receive)
        out.listen[pdo.cob_id & canopen::kPdoCobIdMask].insert(present[i]);
  }
  return out;
}

ReplayPlan plan_replay(const show::Desk& desk, const ReplayChoice& wanted, std::string_view recording,
                       const ReplayDrives& drives) {
  Choice choice(desk, wanted, drives);
  std::size_t extended = 0;
  const auto add = [&](const can::LogFrame& line) {
    if (is_of_canopen(line.frame)) choice.add(line);
    extended += line.frame.extended && !line.frame.error;
    return true;
  };
  auto strays = for_each_frame_of(recording, wanted.channel, add, wanted.read);
  auto out = std::move(choice).take();
  out.extended = extended;
  out.strays = strays;
  return out;
}

std::string kinds_text(const FrameKinds& kinds) {
  std::string out;
  std::size_t told = 0;
  for (const auto& [kind, count] : kinds) {
    if (told == kMostKinds) return out + formatted(", and {} other kinds", kinds.size() - told);
    out += formatted("{}{} {}", told++ == 0 ? "" : ", ", count, kind);
  }
  return out;
}

}  // namespace servoctl::traffic
