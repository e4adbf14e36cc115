#include "session/measure.hpp"

#include "drive/quantity.hpp"

namespace servoctl::session {
namespace {

using drive::Quotient;

void add_requests(const Quotient& quotient, std::uint8_t node, std::vector<SdoRequest>& out) {
  for (const auto* factors : {&quotient.multiply, &quotient.divide})
    for (const auto& factor : *factors)
      if (const auto* object = std::get_if<ObjectAddress>(&factor))
        out.push_back({.node = node, .object = *object});
  for (const auto& condition : quotient.when) out.push_back({.node = node, .object = condition.object});
}

/// The number an object holds, in its unit.
std::optional<double> number(const drive::Profile& profile, ObjectAddress object,
                             const Result<Bytes>& answer) {
  if (!answer) return std::nullopt;
  const auto meaning = drive::meaning(drive::target_at(&profile, object), 0);
  const auto value = od::decode(meaning.type, *answer);
  return value ? std::optional(drive::scaled(meaning, *value)) : std::nullopt;
}

/// Takes the answers in the order of add_requests().
class Evaluation {
 public:
  Evaluation(const drive::Profile& profile, std::span<const Result<Bytes>> answers)
      : profile_(&profile), answers_(answers) {}

  std::optional<double> of(const Quotient& quotient) {
    const auto above = product(quotient.multiply);
    const auto below = product(quotient.divide);
    bool holds = true;
    for (const auto& condition : quotient.when) {
      const auto& answer = answers_[next_++];
      holds = holds && answer && load_le(*answer) == condition.value;
    }
    if (!holds || !above || !below || *below == 0) return std::nullopt;
    return *above / *below;
  }

 private:
  std::optional<double> product(const std::vector<Quotient::Factor>& factors) {
    std::optional<double> out = 1;
    for (const auto& factor : factors) {
      const auto* object = std::get_if<ObjectAddress>(&factor);
      const auto value = object != nullptr ? number(*profile_, *object, answers_[next_++])
                                           : std::optional(std::get<double>(factor));
      out = out && value ? std::optional(*out * *value) : std::nullopt;
    }
    return out;
  }

  const drive::Profile* profile_;
  std::span<const Result<Bytes>> answers_;
  std::size_t next_ = 0;
};

}  // namespace

std::vector<std::optional<double>> read_measures(Session& session, const drive::Profile& profile,
                                                 std::span<const MeasureQuestion> questions) {
  const auto& known = profile.rules.units;
  std::vector<SdoRequest> requests;
  for (const auto& question : questions)
    if (const auto quotient = known.find(question.measure); quotient != known.end())
      add_requests(quotient->second, question.node, requests);
  const auto answers = session.transfer(requests);
  Evaluation evaluation(profile, answers);
  std::vector<std::optional<double>> out;
  for (const auto& question : questions) {
    const auto quotient = known.find(question.measure);
    out.push_back(quotient == known.end() ? std::nullopt : evaluation.of(quotient->second));
  }
  return out;
}

}  // namespace servoctl::session
