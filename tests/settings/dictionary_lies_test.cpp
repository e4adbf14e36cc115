// A data sheet against a drive that contradicts it in two hundred places, over CAN.
#include <algorithm>
#include <functional>
#include <random>

#include "dictionary_check_fixture.hpp"

namespace servoctl::settings {
namespace {

/// Makes the file or the drive lie about an entry; false: this entry cannot carry the lie.
using Lie = std::function<bool(LyingNode&, od::EdsFile&, const od::Object&, od::Entry&, Found&)>;

bool is_plain(const od::Object& object) { return object.entries.size() == 1; }

const std::vector<Lie>& lies() {
  static const std::vector<Lie> kLies{
      [](LyingNode& node, od::EdsFile&, const od::Object& object, od::Entry& entry, Found& out) {
        if (!is_plain(object) && entry.address.sub == 0) return false;
        node.objects.values.erase(entry.address);
        out.emplace(entry.address, Difference::missing);
        return true;
      },
      [](LyingNode& node, od::EdsFile&, const od::Object&, od::Entry& entry, Found& out) {
        auto& bytes = node.objects.values[entry.address];
        if (!od::size_of(entry.type) || !od::readable(entry.access)) return false;
        bytes.resize(bytes.size() == 4 ? 2 : bytes.size() + 1);
        out.emplace(entry.address, Difference::size);
        return true;
      },
      [](LyingNode& node, od::EdsFile&, const od::Object&, od::Entry& entry, Found& out) {
        auto& bytes = node.objects.values[entry.address];
        if (!od::size_of(entry.type) || !od::readable(entry.access)) return false;
        bytes.resize(9);  // Segmented.
        out.emplace(entry.address, Difference::size);
        return true;
      },
      [](LyingNode& node, od::EdsFile&, const od::Object&, od::Entry& entry, Found& out) {
        if (!od::readable(entry.access)) {
          node.objects.write_only.erase(entry.address);
        } else {
          node.objects.write_only.insert(entry.address);
        }
        out.emplace(entry.address, Difference::access);
        return true;
      },
      [](LyingNode& node, od::EdsFile&, const od::Object&, od::Entry& entry, Found& out) {
        if (!od::readable(entry.access) || node.objects.values[entry.address].size() != 2) return false;
        entry.type = od::DataType::string;
        entry.default_value = entry.low = entry.high = {};
        node.objects.values[entry.address] = {1, 2};
        out.emplace(entry.address, Difference::type);
        return true;
      },
      [](LyingNode& node, od::EdsFile&, const od::Object&, od::Entry& entry, Found& out) {
        if (!od::readable(entry.access) || !od::size_of(entry.type) || !od::is_integer(entry.type))
          return false;
        entry.access = od::Access::constant;
        entry.low = entry.high = {};
        auto& bytes = node.objects.values[entry.address];
        entry.default_value = od::NodeValue{od::decode(entry.type, bytes).value()};
        bytes.front() ^= 1U;
        out.emplace(entry.address, Difference::default_value);
        return true;
      },
      [](LyingNode& node, od::EdsFile&, const od::Object&, od::Entry& entry, Found& out) {
        if (!od::readable(entry.access) || entry.type != od::DataType::u16) return false;
        entry.default_value = {};
        entry.low = od::NodeValue{od::Value(std::uint64_t{10})};
        entry.high = od::NodeValue{od::Value(std::uint64_t{20})};
        node.objects.values[entry.address] = {static_cast<std::uint8_t>(entry.address.sub % 2 == 0 ? 9 : 21),
                                              0};
        out.emplace(entry.address, Difference::limits);
        return true;
      },
      [](LyingNode& node, od::EdsFile&, const od::Object&, od::Entry& entry, Found& out) {
        if (!od::readable(entry.access)) return false;
        node.silent.insert(entry.address);
        out.emplace(entry.address, Difference::no_answer);
        return true;
      },
      [](LyingNode&, od::EdsFile& sheet, const od::Object& object, od::Entry& entry, Found& out) {
        // The file forgets the entry; the drive's sub 0 counts it.
        if (is_plain(object) || entry.address.sub == 0) return false;
        const auto address = entry.address;
        auto* listed = sheet.dictionary.object(address.index);
        std::erase_if(listed->entries, [&](const od::Entry& each) { return each.address == address; });
        out.emplace(address, Difference::unlisted);
        return true;
      },
      [](LyingNode& node, od::EdsFile& sheet, const od::Object& object, od::Entry&, Found& out) {
        // The drive has one object more, beside one of the file.
        const ObjectAddress beside{static_cast<std::uint16_t>(object.index + 1), 0};
        if (sheet.dictionary.object(beside.index) != nullptr || beside.index % 0x1000 == 0 ||
            beside.index < 0x2000)
          return false;
        node.objects.values[beside] = {0, 0};
        out.emplace(beside, Difference::unlisted);
        return true;
      },
  };
  return kLies;
}

/// Sub 0 decides what is asked for beside it, and the numbers decide which drive it is.
bool may_carry_a_lie(const od::Object& object, const od::Entry& entry) {
  return entry.address.index >= 0x2000 && (is_plain(object) || entry.address.sub != 0) &&
         entry.address != ObjectAddress{0x6041, 0};
}

TEST_F(DictionaryCheckTest, FindsEachOfTwoHundredSeededLiesAndNothingElse) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
    std::mt19937 random(seed);
    file.dictionary = family.dictionary;
    node_.reset();
    std::vector<ObjectAddress> places;
    for (const auto& object : family.dictionary.objects())
      for (const auto& entry : object.entries)
        if (may_carry_a_lie(object, entry)) places.push_back(entry.address);
    std::shuffle(places.begin(), places.end(), random);
    Found expected;
    std::vector<std::size_t> told(lies().size());
    for (std::size_t i = 0; i < places.size() && expected.size() < 200; ++i) {
      auto* entry = file.dictionary.find(places[i]);
      const auto* object = family.dictionary.object(places[i].index);
      for (std::size_t k = 0; entry != nullptr && k < lies().size(); ++k) {
        const auto kind = (i + k) % lies().size();
        const auto before = expected.size();
        if (!lies()[kind](node(), file, *object, *entry, expected)) continue;
        if (expected.size() > before) ++told[kind];
        break;
      }
    }
    ASSERT_EQ(expected.size(), 200U);
    for (std::size_t kind = 0; kind < told.size(); ++kind)
      EXPECT_GT(told[kind], 0U) << "lie " << kind << " with seed " << seed;
    EXPECT_EQ(listed_text(found()), listed_text(expected)) << "seed " << seed;
  }
}

}  // namespace
}  // namespace servoctl::settings
