#include "session/measure.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "drive/quantity.hpp"

namespace servoctl::session {
namespace {

using drive::Quotient;

/// What the ways to a measure are made of, each object once.
std::vector<ObjectAddress> objects_of(const drive::Quotients& ways) {
  std::vector<ObjectAddress> out;
  for (const auto& way : ways)
    for (const auto object : way.objects())
      if (std::find(out.begin(), out.end(), object) == out.end()) out.push_back(object);
  return out;
}

/// The number an object holds, in its unit.
std::optional<double> number(const drive::Profile& profile, ObjectAddress object,
                             const Result<Bytes>& answer) {
  if (!answer) return std::nullopt;
  const auto meaning = drive::meaning(drive::target_at(&profile, object), 0);
  const auto value = od::decode(meaning.type, *answer);
  return value ? std::optional(drive::scaled(meaning, *value)) : std::nullopt;
}

/// What the objects of one node answered.
class Evaluation {
 public:
  explicit Evaluation(const drive::Profile& profile) : profile_(&profile) {}

  void add(ObjectAddress object, const Result<Bytes>& answer) { answers_.emplace(object, &answer); }

  /// By the first way whose conditions hold and that says something.
  std::optional<Measured> of(const MeasureQuestion& question, const drive::Quotients& ways) const {
    const bool of_turn = question.measure != drive::Measure::rated_torque;
    for (const auto& way : ways) {
      if (!holds(way) || (way.learned && !question.learned)) continue;
      auto value = of(way);
      if (value && way.learned) *value *= *question.learned;
      // A gear that nobody has set makes one increment of a turn.
      if (value && (!of_turn || way.learned || *value > 1)) return Measured{*value, way.learned, &way};
    }
    return std::nullopt;
  }

 private:
  bool holds(const Quotient& way) const {
    return std::all_of(way.when.begin(), way.when.end(), [&](const Quotient::When& condition) {
      const auto& answer = *answers_.at(condition.object);
      return answer && load_le(*answer) == condition.value;
    });
  }

  std::optional<double> of(const Quotient& way) const {
    auto above = product(way.multiply);
    const auto below = product(way.divide);
    for (const auto object : way.power_of_two) {
      const auto exponent = number(*profile_, object, *answers_.at(object));
      above =
          above && exponent ? std::optional(std::ldexp(*above, static_cast<int>(*exponent))) : std::nullopt;
    }
    if (!above || !below || *below == 0) return std::nullopt;
    return *above / *below;
  }

  std::optional<double> product(const std::vector<Quotient::Factor>& factors) const {
    std::optional<double> out = 1;
    for (const auto& factor : factors) {
      const auto* object = std::get_if<ObjectAddress>(&factor);
      const auto value = object != nullptr ? number(*profile_, *object, *answers_.at(*object))
                                           : std::optional(std::get<double>(factor));
      out = out && value ? std::optional(*out * *value) : std::nullopt;
    }
    return out;
  }

  const drive::Profile* profile_;
  std::unordered_map<ObjectAddress, const Result<Bytes>*> answers_;
};

}  // namespace

std::vector<std::optional<Measured>> read_measures(Session& session, const drive::Profile& profile,
                                                   std::span<const MeasureQuestion> questions,
                                                   std::optional<Error>* unanswered) {
  const auto& known = profile.rules.units;
  const auto ways_of = [&](const MeasureQuestion& question) {
    const auto found = known.find(question.measure);
    return found == known.end() ? nullptr : &found->second;
  };
  std::vector<SdoRequest> requests;
  for (const auto& question : questions)
    if (const auto* ways = ways_of(question))
      for (const auto object : objects_of(*ways))
        requests.push_back({.node = question.node, .object = object});
  const auto answers = session.transfer(requests);
  for (const auto& answer : answers)
    if (unanswered != nullptr && !answer && answer.error().code != Errc::sdo_abort)
      *unanswered = answer.error();
  std::vector<std::optional<Measured>> out;
  std::size_t next = 0;
  for (const auto& question : questions) {
    const auto* ways = ways_of(question);
    if (ways == nullptr) {
      out.emplace_back();
      continue;
    }
    Evaluation evaluation(profile);
    for (const auto object : objects_of(*ways)) evaluation.add(object, answers[next++]);
    out.push_back(evaluation.of(question, *ways));
  }
  return out;
}

}  // namespace servoctl::session
