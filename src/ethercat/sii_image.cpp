#include "ethercat/sii_image.hpp"

#include <algorithm>

#include "base/format.hpp"
#include "ethercat/frame.hpp"
#include "ethercat/registers.hpp"
#include "ethercat/words.hpp"

namespace servoctl::ethercat {
namespace {

constexpr std::size_t kConfiguration = 14;  ///< Bytes under the checksum behind them.
constexpr std::size_t kLeastMailbox = 16;   ///< Its header, that of CoE, and 8 bytes.

enum Category : std::uint16_t {
  kStrings = 10,
  kGeneral = 30,
  kFmmu = 40,
  kSyncManagers = 41,
  kTxPdo = 50,
  kRxPdo = 51,
  kDcModes = 60,
};

std::string string_at(const SiiImage& image, std::uint8_t number) {
  return number == 0 || number > image.strings.size() ? std::string() : image.strings[number - 1U];
}

SiiMailbox mailbox(ByteSpan image, std::size_t at) {
  return {word_at(image, at), word_at(image, at + 2), word_at(image, at + 4), word_at(image, at + 6)};
}

/// Memory that was never written, or erased: all zeros or all ones.
bool is_blank(ByteSpan bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](auto b) { return b == 0x00; }) ||
         std::all_of(bytes.begin(), bytes.end(), [](auto b) { return b == 0xFF; });
}

/// One image, category by category. Strings come first: others name them by their number.
class Parser {
 public:
  explicit Parser(ByteSpan image) : image_(image) {}

  SiiImage parse() {
    if (image_.size() < 2 * kSiiHeader) {
      doubt(formatted("it ends after {} bytes, before its first category", image_.size()));
      return std::move(out_);
    }
    // Identity and mailboxes say whether it was ever written; the words in front may be those of a chip.
    if (is_blank(image_.subspan(0x10, 0x30))) {
      doubt("it is empty: no identity, no mailboxes");
      return std::move(out_);
    }
    header();
    walk(&Parser::strings_only);
    walk(&Parser::all_but_strings);
    return std::move(out_);
  }

 private:
  using Visit = void (Parser::*)(std::uint16_t type, ByteSpan data);

  void doubt(std::string text) {
    if (std::find(out_.doubts.begin(), out_.doubts.end(), text) == out_.doubts.end())
      out_.doubts.push_back(std::move(text));
  }

  void header() {
    const auto expected = sii_checksum(image_.first(kConfiguration));
    if (image_[kConfiguration] != expected)
      doubt(formatted("the checksum of its first words is {:02X}h and should be {:02X}h",
                      image_[kConfiguration], expected));
    out_.alias = word_at(image_, 0x08);
    out_.vendor = dword_at(image_, 0x10);
    out_.product = dword_at(image_, 0x14);
    out_.revision = dword_at(image_, 0x18);
    out_.serial = dword_at(image_, 0x1C);
    out_.bootstrap = mailbox(image_, 0x28);
    out_.mailbox = mailbox(image_, 0x30);
    if (const auto odd = out_.mailbox.doubt(); !odd.empty()) doubt(odd);
    out_.protocols = word_at(image_, 0x38);
    const auto kbits = word_at(image_, 0x7C);
    out_.size = kbits == 0 || kbits == 0xFFFF ? 0 : (kbits + std::size_t{1}) * 128;
  }

  void walk(Visit visit) {
    for (std::size_t at = 2 * kSiiHeader;;) {
      if (at + 2 > image_.size()) return doubt("its categories have no end mark");
      const auto type = word_at(image_, at);
      if (type == kSiiEnd) return;
      if (at + 4 > image_.size()) return doubt("it ends within the header of a category");
      const std::size_t size = 2U * word_at(image_, at + 2);
      if (type == 0 && size == 0) return doubt("its categories are not terminated");
      if (at + 4 + size > image_.size())
        return doubt(
            formatted("its category {} announces {} bytes and has {}", type, size, image_.size() - at - 4));
      (this->*visit)(type, image_.subspan(at + 4, size));
      at += 4 + size;
    }
  }

  void strings_only(std::uint16_t type, ByteSpan data) {
    if (type == kStrings) strings(data);
  }
  void all_but_strings(std::uint16_t type, ByteSpan data) {
    switch (type) {
      case kGeneral: return general(data);
      case kFmmu: out_.fmmu_use.assign(data.begin(), data.end()); return;
      case kSyncManagers: return sync_managers(data);
      case kTxPdo: return pdos(data, out_.tx_pdos);
      case kRxPdo: return pdos(data, out_.rx_pdos);
      case kDcModes: return dc_modes(data);
      default: return;
    }
  }

  void strings(ByteSpan data) {
    if (data.empty()) return;
    const std::size_t count = data[0];
    std::size_t at = 1;
    for (std::size_t i = 0; i < count; ++i) {
      if (at >= data.size() || at + 1 + data[at] > data.size())
        return doubt(formatted("it announces {} strings and has {}", count, i));
      const auto text = data.subspan(at + 1, data[at]);
      out_.strings.emplace_back(text.begin(), text.end());
      at += 1 + text.size();
    }
  }

  void general(ByteSpan data) {
    if (data.size() < 6) return doubt("its general category is too short");
    out_.has_general = true;
    out_.group = string_at(out_, data[0]);
    out_.order = string_at(out_, data[2]);
    out_.name = string_at(out_, data[3]);
    out_.coe = data[5];
  }

  void sync_managers(ByteSpan data) {
    for (; data.size() >= 8; data = data.subspan(8)) {
      SiiSyncManager row;
      row.start = word_at(data, 0);
      row.length = word_at(data, 2);
      row.control = data[4];
      row.enable = data[6];
      row.use = data[7] <= 4 ? static_cast<SiiSyncManager::Use>(data[7]) : SiiSyncManager::Use::unused;
      out_.sync_managers.push_back(row);
    }
    if (!data.empty()) doubt("its list of sync managers is truncated");
  }

  void pdos(ByteSpan data, std::vector<SiiPdo>& list) {
    while (data.size() >= 8) {
      SiiPdo pdo;
      pdo.index = word_at(data, 0);
      const std::size_t count = data[2];
      pdo.sync_manager = data[3];
      pdo.name = string_at(out_, data[5]);
      pdo.flags = word_at(data, 6);
      if (data.size() < 8 + 8 * count)
        return doubt(formatted("its PDO {:04X}h announces {} entries and has {}", pdo.index, count,
                               data.size() / 8 - 1));
      for (std::size_t i = 1; i <= count; ++i) {
        const auto row = data.subspan(8 * i, 8);
        pdo.entries.push_back({{word_at(row, 0), row[2]}, string_at(out_, row[3]), row[4], row[5]});
      }
      data = data.subspan(8 + 8 * count);
      list.push_back(std::move(pdo));
    }
    if (!data.empty()) doubt("its list of PDOs is truncated");
  }

  void dc_modes(ByteSpan data) {
    constexpr std::size_t kRow = 24;
    for (; data.size() >= kRow; data = data.subspan(kRow))
      out_.dc_modes.push_back(
          {string_at(out_, data[18]), dword_at(data, 0), dword_at(data, 4), word_at(data, 14)});
    if (!data.empty()) doubt("its list of DC modes is truncated");
  }

  ByteSpan image_;
  SiiImage out_;
};

}  // namespace

std::string SiiMailbox::doubt() const {
  if (!exists()) return {};
  const auto least = std::min(out_size, in_size);
  const auto most = std::max(out_size, in_size);
  if (least < kLeastMailbox)
    return formatted("a mailbox has {} bytes, an SDO needs {}", least, kLeastMailbox);
  if (most > kMaxDatagramData)
    return formatted("a mailbox has {} bytes, a frame holds {}", most, kMaxDatagramData);
  if (std::min(out_start, in_start) < reg::kProcessMemory) return "a mailbox overlaps the registers";
  const bool apart = out_start + out_size <= in_start || in_start + in_size <= out_start;
  return apart ? std::string() : "its mailboxes overlap";
}

std::size_t SiiPdo::bits() const {
  std::size_t out = 0;
  for (const auto& entry : entries) out += entry.bits;
  return out;
}

const SiiSyncManager* SiiImage::sync_manager(SiiSyncManager::Use use) const {
  const auto row = std::find_if(sync_managers.begin(), sync_managers.end(),
                                [&](const SiiSyncManager& manager) { return manager.use == use; });
  return row == sync_managers.end() ? nullptr : &*row;
}

std::uint8_t sii_checksum(ByteSpan configuration) {
  unsigned crc = 0xFF;
  for (const auto byte : configuration) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = ((crc & 0x80U) != 0 ? crc << 1U ^ 0x07U : crc << 1U) & 0xFFU;
  }
  return static_cast<std::uint8_t>(crc);
}

SiiImage parse_sii(ByteSpan image) { return Parser(image).parse(); }

}  // namespace servoctl::ethercat
