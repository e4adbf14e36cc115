#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "canopen/sdo_abort.hpp"
#include "session/can_network.hpp"
#include "session/pdo_change.hpp"
#include "session/pdo_setup.hpp"
#include "sim/sim_bus.hpp"
#include "sim/sim_drive.hpp"
#include "tests/source_dir.hpp"

namespace servoctl::session {

/// What goes wrong with one of the SDO requests, reads and writes, counted from 0; -1: nothing.
struct StepTrouble {
  int refused = -1;
  int silent = -1;     ///< The drive is gone from here on.
  int cancelled = -1;  ///< Ctrl-C after it.
  bool refuses_empty_entries = false;
};

/// A simulated bus that sees the SDO requests to a drive, and the drive's COB-IDs after each frame.
class PdoBus final : public can::Bus {
 public:
  PdoBus(sim::SimBus& bus, sim::SimDrive& drive, StepTrouble trouble)
      : bus_(&bus), drive_(&drive), trouble_(trouble) {
    for (const auto& object : drive.profile().dictionary.objects())
      if (const auto place = canopen::pdo_at(object.index); place && !place->mapping)
        cob_ids_.push_back({object.index, 1});
  }

  TimePoint now() const override { return bus_->now(); }
  TimePoint next_event() const override { return bus_->next_event(); }
  Result<void> send(const can::Frame& frame) override {
    const auto command = frame.data[0] & 0xE0U;
    const bool to_drive = frame.id == 0x600U + drive_->node();
    const bool write = to_drive && command == 0x20;
    if (write || frame.id == 0) sent.push_back(can::to_string(frame));
    if (!write && !(to_drive && command == 0x40)) return pass(frame);
    const int number = requests++;
    if (number == trouble_.silent) drive_->wire_faults().silent = true;
    if (number != trouble_.refused && !(write && trouble_.refuses_empty_entries && is_empty_entry(frame)))
      return pass(frame);
    auto refusal = can::parse_frame("580#8000000000000406").value();
    refusal.id += drive_->node();
    std::copy_n(frame.data.begin() + 1, 3, refusal.data.begin() + 1);
    refusal_ = refusal;
    refused = static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8U);
    return {};
  }
  Result<std::optional<can::Frame>> receive(TimePoint deadline) override {
    if (refusal_) return std::exchange(refusal_, std::nullopt);
    return bus_->receive(deadline);
  }
  bool is_cancelled() const { return trouble_.cancelled >= 0 && requests > trouble_.cancelled; }

  std::vector<std::string> sent;  ///< SDO writes and NMT commands.
  int requests = 0;
  std::uint16_t refused = 0;   ///< Index of what was refused last.
  bool shared_cob_id = false;  ///< Two valid PDOs had one at some moment.

 private:
  Result<void> pass(const can::Frame& frame) {
    auto sent_on = bus_->send(frame);
    std::set<std::uint64_t> valid;
    for (const auto object : cob_ids_) {
      const auto cob_id = load_le(drive_->value(object));
      if ((cob_id & canopen::kPdoInvalid) == 0 && !valid.insert(cob_id & canopen::kPdoCobIdMask).second)
        shared_cob_id = true;
    }
    return sent_on;
  }
  static bool is_empty_entry(const can::Frame& frame) {
    const auto place = canopen::pdo_at(static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8U));
    return place && place->mapping && frame.data[3] > 0 &&
           std::all_of(frame.data.begin() + 4, frame.data.begin() + 8, [](auto byte) { return byte == 0; });
  }

  sim::SimBus* bus_;
  sim::SimDrive* drive_;
  StepTrouble trouble_;
  std::vector<ObjectAddress> cob_ids_;
  std::optional<can::Frame> refusal_;
};

/// One simulated drive of a family, Operational, whose PDOs are changed by the client's own idea of the
/// family.
class PdoWorld {
 public:
  PdoWorld(drive::Profile drive_profile, std::uint8_t node)
      : profile_(std::move(drive_profile)), drive_(profile_, node, memory_, "1"), client_profile(&profile_) {
    bus_.attach(drive_);
    auto quiet = session({});
    (void)quiet.wait([] { return false; }, quiet.now() + std::chrono::seconds(1));
    (void)quiet.can()->send(canopen::nmt_frame(canopen::NmtCommand::start, node));
  }

  static drive::Profile profile_of(std::string_view family) {
    static std::map<std::string, drive::Profile, std::less<>> loaded;
    if (const auto found = loaded.find(family); found != loaded.end()) return found->second;
    const std::filesystem::path folders[] = {std::filesystem::path(source_dir()) / "eds"};
    return loaded.emplace(family, drive::load_profile(family, folders).value()).first->second;
  }

  sim::SimDrive& drive() { return drive_; }
  const drive::Profile& profile() const { return profile_; }

  /// What the drive holds, asked on a quiet bus; entries in use only.
  Values read() {
    drive_.wire_faults() = {};
    auto quiet = session({});
    const auto node = drive_.node();
    return read_pdo_values(quiet, &profile_, std::span(&node, 1)).front().value();
  }

  /// Writes these PDOs over what is there.
  RestoreOutcome change(const std::vector<canopen::Pdo>& wanted, StepTrouble trouble = {},
                        const Values& assignments = {}) {
    auto present = read();
    Values values = assignments;
    for (const auto& pdo : wanted)
      for (auto& [object, data] : values_of(pdo, present)) values.emplace(object, data);
    auto quiet = session({});
    EXPECT_TRUE(complete(quiet, drive_.node(), present, values));
    auto troubled = session(trouble);
    const auto* bus = last_bus_;
    auto outcome = change_pdos(troubled, client_profile, drive_.node(), present, values, {});
    sent = bus->sent;
    requests = bus->requests;
    refused = bus->refused;
    shared_cob_id = bus->shared_cob_id;
    return outcome;
  }

  /// A PDO of the drive as it is, to be changed.
  canopen::Pdo pdo(std::string_view name) {
    const auto like = canopen::parse_pdo_name(name).value();
    for (auto& each : pdos_of(read()))
      if (each.direction == like.direction && each.number == like.number) return each;
    ADD_FAILURE() << name;
    return like;
  }

  /// Refuses and cancels as told; the bus lives as long as the session.
  Session session(StepTrouble trouble) {
    auto bus = std::make_unique<PdoBus>(bus_, drive_, trouble);
    auto* seen = last_bus_ = bus.get();
    Options options;
    options.timeout = std::chrono::milliseconds(50);  // The simulated drive answers at once or never.
    options.cancelled = [seen] { return seen->is_cancelled(); };
    return Session(std::move(bus), "sim", std::move(options));
  }

 private:
  drive::Profile profile_;
  sim::SimBus bus_{sim::SimBus::Clock::virtual_time};
  sim::Memory memory_;
  sim::SimDrive drive_;
  PdoBus* last_bus_ = nullptr;

 public:
  const drive::Profile* client_profile;
  std::vector<std::string> sent;
  int requests = 0;
  std::uint16_t refused = 0;
  bool shared_cob_id = false;
};

inline canopen::PdoEntry entry(std::uint32_t mapping) { return canopen::parse_pdo_entry(mapping); }

}  // namespace servoctl::session
