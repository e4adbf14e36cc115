#pragma once

#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ethercat/al_request.hpp"
#include "ethercat/ring_look.hpp"
#include "ethercat/sii_image.hpp"
#include "session/ethercat_node.hpp"
#include "session/ethercat_wire.hpp"
#include "session/network.hpp"
#include "session/protection.hpp"

namespace servoctl::session {

/// A ring of EtherCAT slaves. A node is a place on it: 1 is the slave next to the master, 127 the last that
/// has a number. Nothing is sent before somebody asks for something, and then the ring is looked at first:
/// where another master works nothing is written.
///
/// Objects are reached through the mailbox of a slave, which is taken from INIT to PRE-OP for that. In an
/// exchange (SAFE-OP, OP) what the process image carries is written and read there. What servoctl has taken
/// above PRE-OP goes back with close().
class EtherCatNetwork final : public Network, private EtherCatTenant {
 public:
  /// `url` stands in messages.
  EtherCatNetwork(std::unique_ptr<ethernet::Port> port, std::string url);

  TimePoint now() const override { return wire_.now(); }
  Result<bool> step(TimePoint deadline) override;
  TimePoint stepped_at() const override { return wire_.stepped_at(); }
  TimePoint next_event() const override { return wire_.next_event(); }
  int poll_fd() const override { return wire_.port().poll_fd(); }
  Result<void> recover(TimePoint deadline) override;
  void set_cancelled(std::function<bool()> cancelled) override { wire_.set_cancelled(std::move(cancelled)); }
  void set_protection(Protection* protection) override { protection_ = protection; }
  std::unique_ptr<ObjectChannel> object_channel(std::uint8_t node, Duration timeout) override;
  const NodeRecords& records() const override { return records_; }
  std::optional<NodeEvent> take_event() override;

  /// INIT, PRE-OP, SAFE-OP and OP, confirmed by the slave: Errc::negative where it refuses, with its reason.
  /// For SAFE-OP and OP its mapping is read, and every output preset from the drive.
  Result<void> request_state(std::uint8_t node, NodeState state) override;
  Result<void> ask_state(std::uint8_t node) override;
  void doubt_state(std::uint8_t) override {}
  bool tells_state() const override { return true; }
  bool must_go_on() const override;
  bool carries(LifeSign::Kind sign) const override { return sign == LifeSign::Kind::process_data; }
  Result<void> arm_watchdog(std::uint8_t node, const LifeSign& sign) override;
  void disarm_watchdog(std::uint8_t node) override;
  Result<void> end_exchange(std::uint8_t node) override;
  bool stays_operational(std::uint8_t node) const override;
  void send_last_word(std::uint8_t node, ObjectAddress object, std::uint16_t value) noexcept override;
  std::unique_ptr<ProcessValues> process_values(std::uint8_t node,
                                                std::span<const ObjectAddress> objects) override;
  std::vector<Message> take_notices() override;
  void flush_trace() override { wire_.port().flush_trace(); }
  Result<void> close() override;
  std::string_view state_title() const override { return "AL state"; }
  bool is_ring() const override { return true; }
  std::string_view state_word(NodeState state) const override;
  std::string silence_hint(std::uint8_t node) const override;
  std::string state_command(std::uint8_t node, NodeState state) const override;
  EtherCatNetwork* ethercat() override { return this; }

  /// What one slave is by its SII, and what its registers say.
  struct Seen {
    ethercat::SlaveLook look;
    std::optional<ethercat::SiiImage> sii;
    std::string sii_error;  ///< Why there is none.
    bool foreign = false;   ///< Another master exchanges process data with it.
  };
  /// Looks at all slaves; changes nothing, and asks no mailbox. `sii`: reads what each says of itself, which
  /// writes to the registers of its access: not of slaves that another master works with; and numbers the
  /// nodes anew where the ring has changed. Errc::bus when nothing comes back, nobody is there, or, without
  /// `sii`, the ring has changed since it was numbered.
  Result<std::vector<Seen>> look(bool sii);
  /// The nodes that objects can be asked of, by their SII: couplers and terminals have no CoE, and a notice
  /// names those that are left out. One whose SII tells nothing is in. Changes no state; where another master
  /// works no SII is read, and all are in. Errors as look(); Errc::negative when none is left.
  Result<std::vector<std::uint8_t>> nodes_with_objects();
  /// Slaves that were there when it was counted last; 0 before.
  std::size_t count() const { return present_; }
  /// What the family of a node says of it, for where its SII does not.
  void learn(std::uint8_t node, const drive::CoeRules& rules) { of(node).rules = rules; }
  /// From now on this node is treated as nobody's, whatever state it is in.
  void take_over(std::uint8_t node) { taken_over_[node & 0x7FU] = true; }
  /// The user wants this node in OP, until another state is asked for or it leaves OP by itself.
  void keep_operational(std::uint8_t node) { of(node).kept = true; }
  /// Makes it ready for transfers; null with a reason. Errors as request_state().
  Result<ethercat::CoeSlave*> mailbox_of(std::uint8_t node);
  using Question = std::function<void(ethercat::CoeInfo&, TimePoint)>;
  /// Asks a slave for a piece of its dictionary (SDO information): `ask` starts one question. Errors as
  /// mailbox_of() and CoeInfo.
  Result<ethercat::CoeInfo::Description> describe(std::uint8_t node, const Question& ask);
  /// What the image of an exchange carries; null while there is none.
  const ethercat::ProcessImage* image_of(std::uint8_t node) const;
  const ethercat::AlStatus* al_of(std::uint8_t node) const;
  const ethercat::Ring::Statistics& statistics() const { return wire_.ring().statistics(); }

 private:
  friend class EtherCatObjectChannel;
  friend class EtherCatValues;
  friend class EtherCatExchange;

  /// A slave as it was found.
  struct Glance {
    std::uint16_t station = 0;
    ethercat::AlStatus al;
    ethercat::SiiMailbox mailbox;  ///< As SM0 and SM1 are set; does not exist where they are off.
  };
  class Records final : public NodeRecords {
   public:
    explicit Records(const EtherCatNetwork& network) : network_(&network) {}
    std::optional<NodeState> state(std::uint8_t node) const override;
    std::uint32_t boots(std::uint8_t node) const override;
    std::uint32_t heartbeats(std::uint8_t node) const override;
    const std::deque<canopen::Emergency>& emergencies(std::uint8_t node) const override;
    std::uint32_t alarms(std::uint8_t node) const override;

   private:
    const EtherCatNetwork* network_;
  };
  /// A look at the states under way.
  struct Watching {
    struct Question {
      std::uint8_t node = 0;
      ethercat::Ring::Ticket ticket = 0;
    };
    std::optional<ethercat::Ring::Ticket> count;
    std::vector<Question> nodes;
    TimePoint next = kNever;
    unsigned lost = 0;  ///< In succession.
    std::optional<std::size_t> counted;
  };

  Result<bool> lacks_objects(std::uint8_t node);
  /// A second signal must not end the program while it has a slave above PRE-OP.
  void set_raised(EtherCatNode& node, bool raised);

  // EtherCatTenant
  void serve(ethercat::Ring& ring, TimePoint now) override;
  TimePoint deadline() const override;

  EtherCatNode& of(std::uint8_t node);
  EtherCatNode* find(std::uint8_t node) const { return nodes_[node & 0x7FU].get(); }
  void serve_node(EtherCatNode& node, ethercat::Ring& ring, TimePoint now);
  void take_emergencies(EtherCatNode& node, TimePoint now);

  // ethercat_bring_up.cpp
  Result<void> prepare(EtherCatNode& node);
  Result<void> approach(EtherCatNode& node);
  Result<Glance> find_slave(EtherCatNode& node);
  Result<void> count_slaves();
  Result<std::vector<Glance>> glance();
  Result<std::vector<Glance>> glance_at(std::size_t count);
  Result<void> claim(const std::vector<Glance>& slaves);
  bool is_foreign(std::uint8_t node, const ethercat::AlStatus& al) const;
  Result<void> check_free(const EtherCatNode& node, const std::vector<Glance>& slaves) const;
  Result<void> bring_up(EtherCatNode& node);
  Result<ethercat::SiiMailbox> mailbox_place(EtherCatNode& node);
  void open_mailbox(EtherCatNode& node, const ethercat::SiiMailbox& place, std::uint8_t first_counter);
  Result<ethercat::AlStatus> go_to(EtherCatNode& node, ethercat::AlState state);
  void forget_mailbox(EtherCatNode& node, const Error& why);
  Error no_answer(std::uint8_t node) const;
  Error nothing_back() const;
  Error numbered_otherwise() const;

  // ethercat_watch.cpp
  void watch(ethercat::Ring& ring, TimePoint now);
  void ask_all(ethercat::Ring& ring, TimePoint now);
  void take_answers(ethercat::Ring& ring, TimePoint now);
  void on_count(const ethercat::Answer& answer);
  void on_state(EtherCatNode& node, const ethercat::Answer& answer, TimePoint now);
  void on_missing(EtherCatNode& node, TimePoint now);
  void hear(EtherCatNode& node, const ethercat::AlStatus& al, TimePoint now, bool expected);
  void end_cycles(EtherCatNode& node);

  void tell(std::uint8_t node, NodeEvent::What what, TimePoint now);

  std::string url_;
  std::array<std::unique_ptr<EtherCatNode>, 128> nodes_;
  std::vector<EtherCatNode*> known_;  ///< Those of `nodes_` that there are.
  std::array<bool, 128> taken_over_{};
  std::size_t count_ = 0;    ///< Slaves when they were numbered.
  std::size_t present_ = 0;  ///< When they were counted last.
  bool numbered_ = false;    ///< Stations are given.
  bool changed_ = false;     ///< They stand otherwise than they were numbered.
  Watching watching_;
  std::deque<NodeEvent> events_;
  std::vector<Message> notices_;
  Records records_{*this};
  Protection* protection_ = nullptr;
  Protection::Hold care_;  ///< While a slave is raised.
  EtherCatWire wire_;      ///< The last: its tenant is whole before it.
};

}  // namespace servoctl::session
