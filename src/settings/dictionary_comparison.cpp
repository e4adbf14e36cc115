#include "settings/dictionary_comparison.hpp"

#include <algorithm>
#include <set>

#include "base/format.hpp"
#include "od/data_sheet.hpp"

namespace servoctl::settings {
namespace {

using report::Show;
using report::Value;

std::string text_of(const std::optional<od::NodeValue>& value) {
  if (!value) return {};
  const auto* number = std::get_if<std::uint64_t>(&value->value);
  if (!value->plus_node_id) return od::to_string(value->value);
  return number != nullptr ? formatted("$NODEID+0x{:X}", *number) : "$NODEID+" + od::to_string(value->value);
}

/// What is compared of an entry, as text; empty where the sheet says nothing.
struct Field {
  std::string_view name;
  std::string (*of)(const od::Entry&);
};
constexpr Field kFields[] = {
    {"name", [](const od::Entry& e) { return e.name; }},
    {"type", [](const od::Entry& e) { return std::string(od::name(e.type)); }},
    {"access", [](const od::Entry& e) { return std::string(od::name(e.access)); }},
    {"pdo", [](const od::Entry& e) { return std::string(od::name(e.pdo)); }},
    {"default", [](const od::Entry& e) { return text_of(e.default_value); }},
    {"min", [](const od::Entry& e) { return text_of(e.low); }},
    {"max", [](const od::Entry& e) { return text_of(e.high); }},
};

bool has_values(const od::EdsFile& file) {
  for (const auto& object : file.dictionary.objects())
    for (const auto& entry : object.entries)
      if (entry.configured) return true;
  return false;
}

std::set<ObjectAddress> addresses(const od::Dictionary& a, const od::Dictionary& b) {
  std::set<ObjectAddress> out;
  for (const auto* dictionary : {&a, &b})
    for (const auto& object : dictionary->objects())
      for (const auto& entry : object.entries) out.insert(entry.address);
  return out;
}

class Comparer {
 public:
  Comparer(const std::string& a, const std::string& b) {
    table_.columns = {{"object", "", Show::text},
                      {"index", "", Show::json},
                      {"sub", "", Show::json},
                      {"name"},
                      {"field"},
                      {"a", a},
                      {"b", b}};
  }

  /// At least one of them is not null.
  void compare(ObjectAddress address, const od::Entry* a, const od::Entry* b) {
    const auto before = table_.rows.size();
    const auto& name = (a != nullptr ? a : b)->name;
    if (a == nullptr || b == nullptr)
      add(address, name, "entry", summary(a), summary(b));
    else
      for (const auto& field : kFields)
        if (field.of(*a) != field.of(*b)) add(address, name, field.name, field.of(*a), field.of(*b));
    if (table_.rows.size() > before) ++different_;
  }

  std::size_t different() const { return different_; }
  report::Table take() { return std::move(table_); }

 private:
  static std::string summary(const od::Entry* entry) {
    return entry == nullptr ? std::string()
                            : formatted("{} {}", od::name(entry->type), od::name(entry->access));
  }

  void add(ObjectAddress address, const std::string& name, std::string_view field, std::string a,
           std::string b) {
    table_.rows.push_back({to_string(address), address.index, address.sub, report::text_or_null(name), field,
                           report::text_or_null(std::move(a)), report::text_or_null(std::move(b))});
  }

  report::Table table_;
  std::size_t different_ = 0;
};

}  // namespace

bool are_data_sheets(const BackupSource& a, const BackupSource& b) {
  if (a.format != BackupFormat::dcf || b.format != BackupFormat::dcf) return false;
  const auto is_without_values = [](const BackupSource& source) {
    const auto file = od::read_data_sheet(source.text, source.file);
    return file && !has_values(*file);
  };
  return is_without_values(a) || is_without_values(b);
}

Result<Value> compare_data_sheets(show::Desk& desk, const BackupSource& a, const BackupSource& b) {
  const auto left = od::read_data_sheet(a.text, a.file);
  if (!left) return fail(left.error());
  const auto right = od::read_data_sheet(b.text, b.file);
  if (!right) return fail(right.error());
  for (const auto& [source, file] : {std::pair(&a, &*left), std::pair(&b, &*right)})
    if (file->error_count() > 0)
      desk.notices.push_back(message("{0}: {1} errors; `eds check {0}` lists what is not compared",
                                     as_it_is(source->file), file->error_count()));
  Comparer comparer(a.file, b.file);
  const auto all = addresses(left->dictionary, right->dictionary);
  for (const auto address : all)
    comparer.compare(address, left->dictionary.find(address), right->dictionary.find(address));
  const auto different = comparer.different();
  if (different > 0) {
    desk.errors.push_back(
        make_error(Errc::negative, message("{} of {} entries differ between {} and {}", different, all.size(),
                                           as_it_is(a.file), as_it_is(b.file))));
  }
  auto table = comparer.take();
  return Value(report::Record{
      {"compared", all.size()},
      {"different", different},
      {"differences", table, Show::json},
      {"table", different == 0 ? Value() : Value(std::move(table)), Show::text, "differences"}});
}

}  // namespace servoctl::settings
