#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "session/ethercat_network.hpp"

namespace servoctl::session {

/// What is wrong with the last cycles of a slave: their working counter, or that they did not come back.
std::string cycle_trouble(const ethercat::ProcessImage::Counts& counts);

/// The way to the objects of one slave: its mailbox, or the process image for what that carries while process
/// data flow. A write into the image has succeeded when the slave has taken a cycle with it; what is read
/// from it was fetched by a cycle that was sent after the last such write, and is two cycles old at most.
class EtherCatObjectChannel final : public ObjectChannel {
 public:
  EtherCatObjectChannel(EtherCatNetwork& network, EtherCatNode& node, Duration timeout)
      : network_(&network), node_(&node), timeout_(timeout) {}
  ~EtherCatObjectChannel() override;

  void set_timeout(Duration timeout) override { timeout_ = timeout; }
  void start_upload(ObjectAddress object, TimePoint now, canopen::Transfer transfer,
                    std::size_t size) override;
  void try_again() override { again_ = true; }
  void start_download(ObjectAddress object, Bytes data, TimePoint now, canopen::Transfer transfer) override;
  Result<void> on_time(TimePoint now) override;
  std::optional<Result<Bytes>> take_result() override;
  bool busy() const override;
  TimePoint deadline() const override;
  std::size_t transferred() const override;
  std::optional<std::size_t> total() const override;

  /// Waits for what was started.
  Result<Bytes> finish_transfer();
  /// The mailbox, or the process image, is no more.
  void on_lost(const Error& why);
  /// The transfer through the mailbox is over.
  void stir() { stirred_ = true; }

 private:
  enum class Way : std::uint8_t { none, waiting, mailbox, output, input };

  void begin(ObjectAddress object, TimePoint now, canopen::Transfer transfer);
  Result<void> set_out();
  void start_mailbox(TimePoint now);
  bool start_image();
  void serve_image(TimePoint now);
  void finish(Result<Bytes> result);

  EtherCatNetwork* network_;
  EtherCatNode* node_;
  Duration timeout_;
  Way way_ = Way::none;
  ObjectAddress object_;
  std::optional<Bytes> data_;
  bool again_ = false;  ///< As try_again() says.
  canopen::Transfer transfer_ = canopen::Transfer::automatic;
  TimePoint until_ = kNever;
  ethercat::ProcessImage::Cycle cycle_ = 0;
  TimePoint fetched_after_{};
  std::optional<Result<Bytes>> result_;
};

}  // namespace servoctl::session
