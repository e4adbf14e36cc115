#include "sim/esc_sii_image.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "base/pdo_index.hpp"
#include "drive/standard_objects.hpp"
#include "ethercat/registers.hpp"
#include "sim/esc_sii.hpp"

namespace servoctl::sim {
namespace reg = ethercat::reg;

namespace {

constexpr std::size_t kSize = 2048;
constexpr std::size_t kCategories = 0x80;  ///< Where the first stands, in bytes.
constexpr std::uint16_t kStrings = 10;
constexpr std::uint16_t kGeneral = 30;
constexpr std::uint16_t kFmmus = 40;
constexpr std::uint16_t kSyncManagers = 41;
constexpr std::uint16_t kTxPdos = 50;
constexpr std::uint16_t kRxPdos = 51;

class SiiBuilder {
 public:
  SiiBuilder(const drive::Profile& profile, const ObjectValues& values)
      : profile_(&profile), values_(&values), out_(kSize, 0) {}

  Bytes build(std::uint16_t alias, SiiFault fault) {
    put_header(alias);
    const auto general = make_general();
    const auto transmit = make_pdos(PdoDirection::transmit);
    const auto receive = make_pdos(PdoDirection::receive);
    add_category(kStrings, make_strings());
    const auto behind_strings = at_;
    add_category(kGeneral, general);
    add_category(kFmmus, {1, 2, 3, 0});
    add_category(kSyncManagers, make_sync_managers());
    add_category(kTxPdos, transmit);
    add_category(kRxPdos, receive);
    put(at_, 0xFFFF, 2);
    spoil(fault, behind_strings);
    return std::move(out_);
  }

 private:
  void put(std::size_t at, std::uint64_t value, std::size_t size) {
    store_le(value, std::span(out_).subspan(at, size));
  }
  void put_word(std::size_t word, std::uint64_t value) { put(word * 2, value, 2); }

  void put_header(std::uint16_t alias) {
    const auto& coe = profile_->rules.coe;
    put_word(0x00, 0x0C08);  // The processor's interface, and how it is clocked.
    put_word(0x04, alias);
    put_word(0x07, sii_crc(ByteSpan(out_).first(14)));
    put(0x08 * 2, values_->number(objects::kVendorId), 4);
    put(0x0A * 2, values_->number(objects::kProductCode), 4);
    put(0x0C * 2, values_->number(objects::kRevision), 4);
    put(0x0E * 2, values_->number(objects::kSerialNumber), 4);
    put_word(0x18, coe.mailbox_out.start);
    put_word(0x19, coe.mailbox_out.size);
    put_word(0x1A, coe.mailbox_in.start);
    put_word(0x1B, coe.mailbox_in.size);
    put_word(0x1C, 0x0004);           // Of the protocols CoE alone.
    put_word(0x3E, kSize / 128 - 1);  // In KiBit, less one.
    put_word(0x3F, 1);
  }

  /// The number of a string, which is noted.
  std::uint8_t string(std::string_view text) {
    const auto found = std::find(strings_.begin(), strings_.end(), text);
    if (text.empty()) return 0;
    if (found != strings_.end()) return static_cast<std::uint8_t>(found - strings_.begin() + 1);
    strings_.emplace_back(text.substr(0, 0xFF));
    return static_cast<std::uint8_t>(strings_.size());
  }

  Bytes make_strings() const {
    Bytes out{static_cast<std::uint8_t>(strings_.size())};
    for (const auto& text : strings_) {
      out.push_back(static_cast<std::uint8_t>(text.size()));
      out.insert(out.end(), text.begin(), text.end());
    }
    return out;
  }

  Bytes make_general() {
    constexpr unsigned kSdo = 1;
    constexpr unsigned kInfo = 2;
    constexpr unsigned kAssign = 4;
    constexpr unsigned kConfigure = 8;
    constexpr unsigned kWholeObjects = 0x20;
    const auto& rules = profile_->rules;
    const auto& name = values_->get(objects::kDeviceName);
    const std::string text(name.begin(), std::find(name.begin(), name.end(), 0));
    Bytes out(32, 0);
    out[0] = string(rules.vendor + " drives");
    out[2] = string(text.empty() ? rules.name : text);
    out[3] = out[2];
    unsigned coe = kSdo | (rules.coe.sdo_info ? kInfo : 0U);
    if (!rules.pdo.assign_rpdo.empty()) coe |= kAssign | kConfigure;
    if (rules.coe.complete_access) coe |= kWholeObjects;
    out[5] = static_cast<std::uint8_t>(coe);
    out[16] = 0x11;  // Two ports with a plug.
    return out;
  }

  Bytes make_sync_managers() const {
    enum : std::uint8_t { kMailboxOut = 1, kMailboxIn, kOutputs, kInputs };
    const auto& coe = profile_->rules.coe;
    Bytes out;
    const auto add = [&](std::uint16_t start, std::uint16_t size, std::uint8_t control, std::uint8_t use) {
      const Bytes row{static_cast<std::uint8_t>(start),
                      static_cast<std::uint8_t>(start >> 8U),
                      static_cast<std::uint8_t>(size),
                      static_cast<std::uint8_t>(size >> 8U),
                      control,
                      0,
                      1,
                      use};
      out.insert(out.end(), row.begin(), row.end());
    };
    add(coe.mailbox_out.start, coe.mailbox_out.size, reg::kSmMailboxOut, kMailboxOut);
    add(coe.mailbox_in.start, coe.mailbox_in.size, reg::kSmMailboxIn, kMailboxIn);
    add(coe.outputs, 0, reg::kSmOutputs, kOutputs);
    add(coe.inputs, 0, reg::kSmInputs, kInputs);
    return out;
  }

  /// All of one direction; none is assigned from the factory.
  Bytes make_pdos(PdoDirection direction) {
    constexpr std::uint8_t kUnassigned = 0xFF;
    constexpr std::uint8_t kFixed = 0x10;
    Bytes out;
    for (const auto& object : profile_->dictionary.objects()) {
      const auto place = pdo_at(object.index);
      if (!place || !place->mapping || place->direction != direction || object.entries.empty()) continue;
      const auto count = static_cast<std::uint8_t>(values_->number({object.index, 0}));
      const bool fixed = !od::writable(object.entries.front().access);
      const Bytes head{static_cast<std::uint8_t>(object.index),
                       static_cast<std::uint8_t>(object.index >> 8U),
                       count,
                       kUnassigned,
                       0,
                       string(object.name),
                       fixed ? kFixed : std::uint8_t{0},
                       0};
      out.insert(out.end(), head.begin(), head.end());
      for (unsigned sub = 1; sub <= count; ++sub)
        add_entry(
            out, static_cast<std::uint32_t>(values_->number({object.index, static_cast<std::uint8_t>(sub)})));
    }
    return out;
  }

  void add_entry(Bytes& out, std::uint32_t mapping) {
    const ObjectAddress object{static_cast<std::uint16_t>(mapping >> 16U),
                               static_cast<std::uint8_t>(mapping >> 8U & 0xFFU)};
    const auto* entry = profile_->dictionary.find(object);
    const auto type = entry != nullptr ? od::cia_code(entry->type) : std::uint16_t{0};
    const Bytes row{static_cast<std::uint8_t>(object.index),
                    static_cast<std::uint8_t>(object.index >> 8U),
                    object.sub,
                    0,
                    static_cast<std::uint8_t>(type),
                    static_cast<std::uint8_t>(mapping),
                    0,
                    0};
    out.insert(out.end(), row.begin(), row.end());
  }

  void add_category(std::uint16_t type, Bytes data) {
    data.resize((data.size() + 1) / 2 * 2);
    constexpr std::size_t kHead = 4;
    constexpr std::size_t kEnd = 2;
    if (data.empty() || at_ + kHead + data.size() + kEnd > kSize) return;
    put(at_, type, 2);
    put(at_ + 2, data.size() / 2, 2);
    std::copy(data.begin(), data.end(), out_.begin() + static_cast<std::ptrdiff_t>(at_ + kHead));
    at_ += kHead + data.size();
  }

  void spoil(SiiFault fault, std::size_t category) {
    if (fault == SiiFault::checksum) out_[14] = static_cast<std::uint8_t>(~out_[14]);
    if (fault == SiiFault::blank) std::fill(out_.begin(), out_.end(), std::uint8_t{0xFF});
    if (fault == SiiFault::cut_short) put(category + 2, 0x7000, 2);
    if (fault == SiiFault::mailboxes) put_word(0x18, profile_->rules.coe.mailbox_in.start);
  }

  const drive::Profile* profile_;
  const ObjectValues* values_;
  std::vector<std::string> strings_;
  Bytes out_;
  std::size_t at_ = kCategories;
};

}  // namespace

Bytes build_sii(const drive::Profile& profile, const ObjectValues& values, std::uint16_t alias,
                SiiFault fault) {
  return SiiBuilder(profile, values).build(alias, fault);
}

}  // namespace servoctl::sim
