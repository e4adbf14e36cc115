#include "drive/bitrate.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "drive/naming.hpp"
#include "drive/quantity.hpp"

namespace servoctl::drive {
namespace {

constexpr std::uint32_t kFastest = 1'000'000;  ///< CiA 301, 5.3: 10 kbit/s to 1 Mbit/s.
constexpr std::uint32_t kSlowest = 10'000;

struct Code {
  std::int64_t value = 0;
  std::uint32_t bitrate = 0;
};

std::vector<Code> codes_of(const Profile& profile) {
  std::vector<Code> out;
  const auto place = place_of(profile, profile.rules.nmt.bitrate);
  if (!place) return out;
  const auto what = meaning(target_at(&profile, *place), 1);
  if (what.labels == nullptr) return out;
  for (const auto& label : *what.labels)
    if (const auto bitrate = parse_bitrate(label.label)) out.push_back({label.value, *bitrate});
  return out;
}

}  // namespace

Result<std::uint32_t> parse_bitrate(std::string_view text) {
  const auto wrong = [&] {
    return fail(Errc::usage, message("'{}' is not a bitrate of CAN", as_it_is(text)),
                "10k to 1M: 125k, 250k, 500k, 1M");
  };
  const auto word = lower(trim(text));
  const auto end = word.find_first_not_of("0123456789.");
  const auto number = parse_real(word.substr(0, end));
  if (!number) return wrong();
  const auto unit = end == std::string::npos ? std::string_view() : trim(std::string_view(word).substr(end));
  double scale = 1;
  if (unit == "k" || unit == "kbit" || unit == "kbit/s" || unit == "kbps")
    scale = 1e3;
  else if (unit == "m" || unit == "mbit" || unit == "mbit/s" || unit == "mbps")
    scale = 1e6;
  else if (!unit.empty() && unit != "bit/s")
    return wrong();
  const auto bitrate = *number * scale;
  if (bitrate != std::floor(bitrate) || bitrate < kSlowest || bitrate > kFastest) return wrong();
  return static_cast<std::uint32_t>(bitrate);
}

std::string bitrate_text(std::uint32_t bitrate) {
  if (bitrate % 1'000'000 == 0) return formatted("{} Mbit/s", bitrate / 1'000'000);
  if (bitrate % 1'000 == 0) return formatted("{} kbit/s", bitrate / 1'000);
  return formatted("{} bit/s", bitrate);
}

std::vector<std::uint32_t> bitrates_of(const Profile& profile) {
  std::vector<std::uint32_t> out;
  for (const auto& code : codes_of(profile)) out.push_back(code.bitrate);
  std::sort(out.begin(), out.end());
  return out;
}

std::optional<std::uint32_t> bitrate_of_code(const Profile& profile, std::int64_t code) {
  for (const auto& known : codes_of(profile))
    if (known.value == code) return known.bitrate;
  return std::nullopt;
}

Result<std::int64_t> bitrate_code(const Profile& profile, std::uint32_t bitrate) {
  const auto& name = profile.rules.nmt.bitrate;
  if (name.empty())
    return fail(Errc::usage,
                message("no parameter of a {} is known that sets its bitrate", as_it_is(profile.family)),
                "look into its manual: switches, its panel, or the vendor's software");
  const auto codes = codes_of(profile);
  if (codes.empty())
    return fail(Errc::usage,
                message("which bitrates the codes of {} stand for is not known of a {}", name,
                        as_it_is(profile.family)),
                message("its manual prints none; `read {}` shows the present code", as_it_is(name)));
  const auto found =
      std::find_if(codes.begin(), codes.end(), [&](const Code& code) { return code.bitrate == bitrate; });
  if (found != codes.end()) return found->value;
  std::vector<std::string> known;
  for (const auto each : bitrates_of(profile)) known.push_back(bitrate_text(each));
  return fail(Errc::usage, message("a {} has no {}", as_it_is(profile.family), bitrate_text(bitrate)),
              message("it has {}", fmt::join(known, ", ")));
}

}  // namespace servoctl::drive
