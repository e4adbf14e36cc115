// What a network sees of its slaves without asking any of them for an object.
#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "base/format.hpp"
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
    for (auto* node : known_)
      forget_mailbox(*node, drive_error(Errc::timeout, node->number, "the ring was numbered anew"));
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
      out[i].sii_error = image.error().message.text();
  }
  return out;
}

Result<bool> EtherCatNetwork::lacks_objects(std::uint8_t node) {
  if (const auto* known = find(node); known != nullptr && known->coe) return false;
  ethercat::SiiReader reader(node, ethercat::SlaveAddress::at_position(static_cast<std::uint16_t>(node - 1)));
  reader.start_head(ethercat::kSiiHeader, now());
  const auto head = wire_.ask(reader);
  if (!head && (head.error().code == Errc::bus || head.error().code == Errc::interrupted))
    return fail(head.error());
  if (!head) return false;
  constexpr std::size_t kConfiguration = 14;
  const auto sii = ethercat::parse_sii(*head);
  const auto checksum = ethercat::sii_checksum(ByteSpan(*head).first(kConfiguration));
  if (sii.is_empty() || checksum != (*head)[kConfiguration]) return false;
  return !sii.mailbox.exists() || (sii.protocols & ethercat::kProtocolCoe) == 0;
}

Result<std::vector<std::uint8_t>> EtherCatNetwork::nodes_with_objects() {
  const auto seen = look(false);
  if (!seen) return fail(seen.error());
  const bool foreign = std::any_of(seen->begin(), seen->end(), [](const Seen& s) { return s.foreign; });
  std::vector<std::uint8_t> out;
  std::vector<std::uint8_t> without;
  for (std::size_t i = 0; i < seen->size(); ++i) {
    const auto node = static_cast<std::uint8_t>(i + 1);
    const auto lacks = foreign ? Result<bool>(false) : lacks_objects(node);
    if (!lacks) return fail(lacks.error());
    (*lacks ? without : out).push_back(node);
  }
  if (out.empty())
    return fail(Errc::negative,
                message("{}: by their SII none of the {} slaves has CoE", as_it_is(url_), seen->size()),
                "`scan` shows what they are; a node named with -n is asked all the same");
  if (!without.empty())
    notices_.push_back(message("-n all leaves out node{} {}: no CoE, by {} SII", plural(without.size()),
                               node_names(without), without.size() == 1 ? "its" : "their"));
  return out;
}

}  // namespace servoctl::session
