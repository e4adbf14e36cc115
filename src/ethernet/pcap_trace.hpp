#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "can/trace.hpp"
#include "ethernet/pcap_format.hpp"
#include "ethernet/port.hpp"

namespace servoctl::ethernet {

/// A port that passes everything on to `inner` and writes every frame, sent and received, to `file`, which
/// Wireshark opens: in the newer form where its name ends in `.pcapng`, else in the classic one. As
/// can::TraceFile, also in its errors, while the port is in use as next_event() asks for; without a trace the
/// port goes on.
Result<std::unique_ptr<Port>> pcap_to(std::unique_ptr<Port> inner, const std::filesystem::path& file,
                                      std::string_view interface_name, can::TraceClock clock,
                                      can::TraceFailed failed = {});

/// See pcap_to().
class PcapPort final : public Port {
 public:
  PcapPort(std::unique_ptr<Port> inner, can::TraceFile file, PcapForm form, Duration clock_offset)
      : file_(std::move(file)), inner_(std::move(inner)), form_(form), clock_offset_(clock_offset) {}

  TimePoint now() const override { return inner_->now(); }
  Result<void> send(ByteSpan frame) override;
  Result<std::optional<ByteSpan>> receive(TimePoint deadline) override;
  TimePoint arrived() const override { return inner_->arrived(); }
  TimePoint next_event() const override;
  int poll_fd() const override { return inner_->poll_fd(); }
  Result<void> recover(TimePoint deadline) override { return inner_->recover(deadline); }
  bool has_link() const override { return inner_->has_link(); }
  std::vector<Message> take_notices() override;
  void flush_trace() override { file_.flush(now()); }
  void end_trace() override {
    inner_.reset();
    file_.end();
  }

 private:
  void record(Direction direction, ByteSpan frame, TimePoint time);

  can::TraceFile file_;
  std::unique_ptr<Port> inner_;
  PcapForm form_;
  Duration clock_offset_;  ///< From the port's clock to the times in the file.
};

}  // namespace servoctl::ethernet
