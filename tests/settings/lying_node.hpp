#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "canopen/sdo_abort.hpp"
#include "canopen/sdo_server.hpp"
#include "drive/profile.hpp"
#include "session/session.hpp"
#include "tests/session/scripted_bus.hpp"

namespace servoctl::settings {

/// Objects with the access of a dictionary, and other lengths and values where a test wants them.
class LyingObjects final : public canopen::ObjectStore {
 public:
  explicit LyingObjects(const od::Dictionary& dictionary) {
    for (const auto& object : dictionary.objects())
      for (const auto& entry : object.entries) add(entry, object);
  }

  std::uint32_t read(ObjectAddress object, Bytes& out) override {
    if (unsupported.contains(object)) return canopen::sdo_abort::kUnsupportedAccess;
    if (const auto refused = refusals.find(object); refused != refusals.end()) return refused->second;
    const auto found = values.find(object);
    if (found == values.end() && answers_all) out = {0};
    if (found == values.end()) return answers_all ? 0 : absence(object);
    if (write_only.contains(object)) return canopen::sdo_abort::kWriteOnly;
    out = found->second;
    return 0;
  }
  std::uint32_t check_writable(ObjectAddress object) override {
    if (!values.contains(object)) return absence(object);
    return read_only.contains(object) ? canopen::sdo_abort::kReadOnly : 0;
  }
  std::uint32_t write(ObjectAddress object, ByteSpan) override {
    writes.push_back(object);
    return canopen::sdo_abort::kReadOnly;
  }
  void remove(std::uint16_t index) {
    std::erase_if(values, [&](const auto& each) { return each.first.index == index; });
  }

  std::map<ObjectAddress, Bytes> values;
  std::set<ObjectAddress> write_only;
  std::set<ObjectAddress> read_only;
  std::set<ObjectAddress> unsupported;
  std::map<ObjectAddress, std::uint32_t> refusals;  ///< The abort code of a read.
  std::uint32_t lacking = 0;                        ///< The abort code for objects that are not there.
  bool answers_all = false;
  std::vector<ObjectAddress> writes;

 private:
  std::uint32_t absence(ObjectAddress object) const {
    if (lacking != 0) return lacking;
    const auto near = values.lower_bound({object.index, 0});
    return near != values.end() && near->first.index == object.index ? canopen::sdo_abort::kNoSubIndex
                                                                     : canopen::sdo_abort::kNoObject;
  }
  void add(const od::Entry& entry, const od::Object& object) {
    auto& bytes = values[entry.address];
    bytes.assign(od::size_of(entry.type).value_or(4), 0);
    if (!od::size_of(entry.type)) bytes = {'t', 'e', 'x', 't', 's'};
    const auto& said = entry.default_value ? entry.default_value : entry.low;
    if (said)
      if (auto encoded = od::encode(entry.type, said->for_node(1))) bytes = std::move(*encoded);
    if (object.entries.size() > 1 && entry.address.sub == 0 && !entry.default_value)
      bytes.assign(1, object.entries.back().address.sub);
    if (!od::readable(entry.access)) write_only.insert(entry.address);
    if (!od::writable(entry.access)) read_only.insert(entry.address);
  }
};

/// Node 1 with these objects on a CAN bus in virtual time; it does not answer requests for `silent` ones.
class LyingNode {
 public:
  explicit LyingNode(const od::Dictionary& dictionary)
      : objects(dictionary), server_(1, objects, canopen::SdoServer::Options{}) {
    auto owned = std::make_unique<session::ScriptedBus>();
    bus = owned.get();
    bus->on_send = [this](session::ScriptedBus& to, const std::string& sent) { answer(to, sent); };
    session.emplace(std::move(owned), "can0", session::Options{});
  }

  LyingObjects objects;
  std::set<ObjectAddress> silent;
  std::set<ObjectAddress> late_once;  ///< The first request for one is lost.
  std::set<ObjectAddress> alarming;   ///< A request for one is answered, and an EMCY sent.
  bool resets_alarms = false;
  std::set<ObjectAddress> booting;  ///< A request for one is answered, and a boot-up sent.
  std::map<ObjectAddress, std::function<void()>> on_request;
  std::vector<ObjectAddress> asked;  ///< Reads, in their order.
  /// Objects from silent_from up to silent_to that it lacks are not answered.
  std::uint16_t silent_from = 0xFFFF;
  std::uint16_t silent_to = 0x3FFF;
  /// Objects that it sends without end, in segments of so many bytes.
  std::map<ObjectAddress, unsigned> endless;
  bool dead = false;
  std::size_t dies_after = 1'000'000;  ///< Requests.
  std::size_t requests = 0;
  session::ScriptedBus* bus = nullptr;
  std::optional<session::Session> session;

 private:
  void answer(session::ScriptedBus& to, const std::string& sent) {
    const auto frame = can::parse_frame(sent).value();
    if (frame.id != 0x601 || dead || ++requests > dies_after) return;
    const ObjectAddress object{static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8U),
                               frame.data[3]};
    const bool begins = (frame.data[0] & 0xE0U) == 0x40;
    if (begins && (silent.contains(object) || late_once.erase(object) > 0)) return;
    if (begins) asked.push_back(object);
    if (begins && object.index >= silent_from && object.index <= silent_to &&
        !objects.values.contains(object))
      return;
    if (streams(to, frame, begins ? endless.find(object) : endless.end())) return;
    if (const auto call = on_request.find(object); begins && call != on_request.end()) call->second();
    if (begins && booting.contains(object)) to.arrive("701#00");
    if (begins && alarming.contains(object)) {
      to.arrive("081#3081210000000000");
      if (resets_alarms) to.arrive("081#0000000000000000");
    }
    server_.on_frame(frame, to.now());
    while (const auto out = server_.take_frame()) to.arrive(*out, std::chrono::milliseconds(1));
  }

  /// Whether the frame is of a transfer that does not end.
  bool streams(session::ScriptedBus& to, const can::Frame& frame,
               std::map<ObjectAddress, unsigned>::const_iterator begun) {
    can::Frame out{.id = 0x581, .size = 8};
    const bool is_segment = (frame.data[0] & 0xE0U) == 0x60;
    if (begun != endless.end()) {
      segment_ = begun->second;
      out.data = {0x40, frame.data[1], frame.data[2], frame.data[3]};
    } else if (segment_ && is_segment) {
      out.data[0] = static_cast<std::uint8_t>((frame.data[0] & 0x10U) | (7U - *segment_) << 1U);
    } else {
      segment_.reset();
      return false;
    }
    to.arrive(out, std::chrono::milliseconds(1));
    return true;
  }

  std::optional<unsigned> segment_;  ///< Bytes of each segment, while it sends without end.
  canopen::SdoServer server_;
};

}  // namespace servoctl::settings
