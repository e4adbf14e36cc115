// What a network sees of its slaves without asking any of them for an object.
#include <algorithm>
#include <utility>

#include "ethercat/request_sequence.hpp"
#include "ethercat/sii_reader.hpp"
#include "session/ethercat_network.hpp"

namespace servoctl::session {

Result<std::vector<EtherCatNetwork::Seen>> EtherCatNetwork::look(bool sii) {
  ethercat::RingLook looking;
  looking.start(now());
  const auto view = wire_.ask(looking);
  if (!view) return fail(watching_.lost > 0 || !wire_.port().has_link() ? nothing_back() : view.error());
  std::vector<Seen> out;
  for (const auto& slave : view->slaves)
    out.push_back({slave, {}, {}, is_foreign(static_cast<std::uint8_t>(out.size() + 1), slave.al)});
  const bool foreign = std::any_of(out.begin(), out.end(), [](const Seen& s) { return s.foreign; });
  // A node is another drive after it: that is for who asks what is there, not for a job that goes on.
  for (std::size_t i = 0; numbered_ && i < out.size(); ++i) {
    const auto at = static_cast<std::uint8_t>(i + 1);
    changed_ = changed_ || (out[i].look.station != 0 && out[i].look.station != station_of(at));
  }
  changed_ = changed_ || (numbered_ && view->count > count_);
  if (changed_ && !sii) return fail(numbered_otherwise());
  if (sii && (changed_ || view->count != count_) && !must_go_on()) {
    for (const auto& node : nodes_)
      if (node) forget_mailbox(*node, drive_error(Errc::timeout, node->number, "the ring was numbered anew"));
    changed_ = numbered_ = false;
  }
  present_ = view->count;
  if (!numbered_) count_ = present_;
  for (std::size_t i = 0; sii && i < out.size(); ++i) {
    if (foreign) out[i].sii_error = "not read: another master works with this ring";
    if (foreign) continue;
    ethercat::SiiReader reader(static_cast<std::uint8_t>(i + 1),
                               ethercat::SlaveAddress::at_position(static_cast<std::uint16_t>(i)));
    reader.start(now());
    const auto image = wire_.ask(reader);
    if (!image && (image.error().code == Errc::bus || image.error().code == Errc::interrupted))
      return fail(image.error());
    if (image)
      out[i].sii = ethercat::parse_sii(*image);
    else
      out[i].sii_error = image.error().message;
  }
  return out;
}

}  // namespace servoctl::session
