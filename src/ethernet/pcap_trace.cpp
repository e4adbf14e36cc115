#include "ethernet/pcap_trace.hpp"

#include <algorithm>

#include "base/text.hpp"

namespace servoctl::ethernet {

Result<void> PcapPort::send(ByteSpan frame) {
  auto sent = inner_->send(frame);
  if (sent)
    record(Direction::sent, frame, now());
  else
    flush_trace();
  return sent;
}

Result<std::optional<ByteSpan>> PcapPort::receive(TimePoint deadline) {
  auto got = inner_->receive(std::min(deadline, file_.flush_due()));
  const bool woken_to_flush = got && !*got && now() >= file_.flush_due() && now() < deadline;
  file_.flush_when_due(now());
  if (woken_to_flush) got = inner_->receive(deadline);
  if (!got)
    flush_trace();
  else if (*got)
    record(Direction::received, **got, arrived());
  return got;
}

TimePoint PcapPort::next_event() const { return std::min(inner_->next_event(), file_.flush_due()); }

void PcapPort::record(Direction direction, ByteSpan frame, TimePoint time) {
  if (!file_) return;
  file_.put(pcap_record(form_, time.time_since_epoch() + clock_offset_, direction, frame), now());
}

std::vector<Message> PcapPort::take_notices() {
  auto out = inner_->take_notices();
  if (auto notice = file_.take_notice()) out.push_back(std::move(*notice));
  return out;
}

Result<std::unique_ptr<Port>> pcap_to(std::unique_ptr<Port> inner, const std::filesystem::path& file,
                                      std::string_view interface_name, can::TraceClock clock,
                                      can::TraceFailed failed) {
  auto log = can::TraceFile::open(file, std::move(failed));
  if (!log) return fail(log.error());
  const auto form = equals_nocase(file.extension().string(), ".pcapng") ? PcapForm::next : PcapForm::classic;
  const auto now = inner->now();
  log->put_head(pcap_head(form, interface_name), now);
  const auto offset = can::trace_offset(clock, now);
  return std::make_unique<PcapPort>(std::move(inner), std::move(*log), form, offset);
}

}  // namespace servoctl::ethernet
