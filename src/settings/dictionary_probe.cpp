#include "settings/dictionary_probe.hpp"

#include <algorithm>
#include <set>
#include <span>
#include <utility>

#include "base/format.hpp"
#include "canopen/sdo_abort.hpp"

namespace servoctl::settings {
namespace {

constexpr std::uint16_t kFirstIndex = 0x1000;  // Below are the data types (CiA 301, table 38).
constexpr std::uint16_t kLastIndex = 0x9FFF;

bool is_in_range(unsigned index) { return index >= kFirstIndex && index <= kLastIndex; }

/// A refusal of the read itself shows that there is something.
bool is_there(const Result<Bytes>& answer) {
  return answer || answer.error().abort_code == canopen::sdo_abort::kWriteOnly;
}

class Prober {
 public:
  Prober(session::ObjectSurvey& survey, const od::Dictionary& file, const od::Dictionary* standard,
         EntryJudge& judge, DictionaryCheck& out)
      : survey_(&survey), file_(&file), standard_(standard), judge_(&judge), out_(&out) {}

  Result<bool> run() {
    if (const auto subs = ask(unlisted_subs()); !subs || !*subs) return subs;
    std::set<ObjectAddress> next;
    for (const auto& object : file_->objects()) add_neighbours(object.index, next);
    if (standard_ != nullptr)
      for (const auto& object : standard_->objects()) add(object.index, next);
    while (!next.empty()) {
      found_.clear();
      if (const auto asked = ask(std::exchange(next, {})); !asked || !*asked) return asked;
      for (const auto object : found_) add_neighbours(object.index, next);
    }
    return true;
  }

 private:
  std::set<ObjectAddress> unlisted_subs() const {
    std::set<ObjectAddress> out;
    for (const auto& object : file_->objects()) {
      if (object.code != od::ObjectCode::array && object.code != od::ObjectCode::record) continue;
      const auto count = out_->values.find({object.index, 0});
      unsigned last = object.entries.empty() ? 0U : object.entries.back().address.sub;
      if (count != out_->values.end() && !count->second.empty())
        last = std::max<unsigned>(last, count->second.front());
      for (unsigned sub = 1; sub <= std::min(last + 1, 254U); ++sub) {
        const ObjectAddress address{object.index, static_cast<std::uint8_t>(sub)};
        if (file_->find(address) == nullptr) out.insert(address);
      }
    }
    return out;
  }

  void add_neighbours(std::uint16_t index, std::set<ObjectAddress>& next) {
    add(index - 1U, next);
    add(index + 1U, next);
  }

  void add(unsigned index, std::set<ObjectAddress>& next) {
    const ObjectAddress address{static_cast<std::uint16_t>(index), 0};
    if (is_in_range(index) && file_->object(address.index) == nullptr && asked_.insert(address).second)
      next.insert(address);
  }

  Result<bool> ask(const std::set<ObjectAddress>& wanted) {
    constexpr std::size_t kPart = 64;
    const std::vector<ObjectAddress> objects(wanted.begin(), wanted.end());
    for (std::size_t at = 0; at < objects.size(); at += kPart) {
      const auto enabled = survey_->is_enabled();
      if (!enabled) return enabled;
      if (*enabled) return false;
      const auto part = std::span(objects).subspan(at, std::min(kPart, objects.size() - at));
      const auto answers = survey_->read(part);
      if (!answers) return fail(answers.error());
      out_->probed += part.size();
      for (std::size_t i = 0; i < part.size(); ++i)
        if (is_there((*answers)[i])) tell(part[i], (*answers)[i]);
    }
    return true;
  }

  void tell(ObjectAddress address, const Result<Bytes>& answer) {
    found_.push_back(address);
    const auto* known = standard_ != nullptr ? standard_->find(address) : nullptr;
    const auto* whole = file_->object(address.index);
    if (whole == nullptr && standard_ != nullptr) whole = standard_->object(address.index);
    od::Object object = whole != nullptr ? *whole : od::Object{};
    object.index = address.index;
    od::Entry entry;
    entry.address = address;
    entry.name = known != nullptr ? known->name : std::string();
    judge_->add(object, entry, Difference::unlisted, {},
                answer ? size_text(answer->size()) : std::string("write-only"));
  }

  session::ObjectSurvey* survey_;
  const od::Dictionary* file_;
  const od::Dictionary* standard_;
  EntryJudge* judge_;
  DictionaryCheck* out_;
  std::set<ObjectAddress> asked_;
  std::vector<ObjectAddress> found_;
};

}  // namespace

Result<bool> probe_unlisted(session::ObjectSurvey& survey, const od::Dictionary& file,
                            const od::Dictionary* standard, EntryJudge& judge, DictionaryCheck& out) {
  return Prober(survey, file, standard, judge, out).run();
}

void compare_description(const od::Dictionary& described, const od::Dictionary& file, EntryJudge& judge,
                         DictionaryCheck& out) {
  const auto has = [&](ObjectAddress address, Difference difference) {
    return std::any_of(out.findings.begin(), out.findings.end(), [&](const DictionaryFinding& found) {
      return found.object == address && found.difference == difference;
    });
  };
  for (const auto& object : described.objects()) {
    if (!is_in_range(object.index)) continue;
    for (const auto& entry : object.entries) {
      const auto* listed = file.find(entry.address);
      if (listed == nullptr) {
        judge.add(object, entry, Difference::unlisted, {},
                  formatted("{} {}", od::name(entry.type), od::name(entry.access)));
        continue;
      }
      const bool same_size = od::size_of(listed->type) == od::size_of(entry.type);
      if (listed->type != entry.type && same_size && !has(entry.address, Difference::type))
        judge.add(object, *listed, Difference::type, std::string(od::name(listed->type)),
                  std::string(od::name(entry.type)));
      const bool same_access = od::readable(listed->access) == od::readable(entry.access) &&
                               od::writable(listed->access) == od::writable(entry.access);
      if (!same_access && !has(entry.address, Difference::access))
        judge.add(object, *listed, Difference::access, std::string(od::name(listed->access)),
                  std::string(od::name(entry.access)));
    }
  }
}

}  // namespace servoctl::settings
