#include "settings/file_transfer.hpp"

#include <algorithm>
#include <string>

#include "base/file.hpp"
#include "base/format.hpp"
#include "canopen/sdo_frame.hpp"
#include "od/real_number.hpp"
#include "session/cob_id_check.hpp"
#include "settings/keeping_nodes.hpp"
#include "settings/stored_copies.hpp"

namespace servoctl::settings {
namespace {

using report::Show;
using report::Value;

report::Table new_table(bool kept) {
  report::Table table;
  table.columns = {{"node"},
                   {"object", "", Show::text},
                   {"index", "", Show::json},
                   {"sub", "", Show::json},
                   {"name"},
                   {"bytes"},
                   {"file"},
                   {"state", "result"},
                   {"error", "", Show::json}};
  if (kept) table.columns.push_back({"kept", "", Show::json});
  if (kept) table.columns.push_back({"kept_text", "kept", Show::text});
  return table;
}

report::List row(const show::Desk& desk, std::uint8_t node, const drive::Target& target, std::size_t bytes,
                 const std::filesystem::path& file, std::string state, Value error) {
  return {node,
          to_string(target.address),
          target.address.index,
          target.address.sub,
          report::text_or_null(desk.chinese ? target.label_zh() : target.label()),
          bytes,
          file.string(),
          std::move(state),
          std::move(error)};
}

}  // namespace

Result<Value> read_to_file(show::Desk& desk, std::uint8_t node, const drive::Target& target,
                           canopen::Transfer transfer, const std::filesystem::path& file) {
  const session::SdoRequest request{node, target.address, {}, transfer};
  const auto answers = desk.session->transfer(std::span(&request, 1));
  const auto& data = answers.front();
  if (!data) return fail(data.error());
  const auto written = write_file_atomically(file, std::string(data->begin(), data->end()));
  if (!written) return fail(written.error());
  auto table = new_table(false);
  table.rows.push_back(row(desk, node, target, data->size(), file, "read", {}));
  return Value(std::move(table));
}

Result<Change> change_from_file(const drive::Profile* profile, std::uint8_t node, const drive::Target& target,
                                const std::filesystem::path& file) {
  const auto meaning = drive::meaning(target, node);
  if (!od::writable(meaning.access))
    return fail(Errc::usage, message("{} is read-only", target.in_sentence()), "it can be read, not written");
  const auto content = read_file(file, canopen::kMaxSdoDownload);
  if (!content) return fail(content.error());
  const auto size = meaning.type_known ? od::size_of(meaning.type) : std::nullopt;
  if (size && content->size() != *size)
    return fail(Errc::usage, message("{} takes {} bytes, {} has {}", target.in_sentence(), *size,
                                     as_it_is(file.string()), content->size()));
  Bytes data(content->begin(), content->end());
  const auto value = size ? od::decode(meaning.type, data) : Result<od::Value>(od::Value(std::uint64_t{0}));
  if (value && !od::is_number(meaning.encoding, *value))
    return fail(Errc::usage, message("{}: the bits in {} are those of infinity or of no number (NaN)",
                                     target.in_sentence(), as_it_is(file.string())));
  if (const auto free = session::check_cob_id(profile, target.address, data, node); !free) {
    auto error = free.error();
    error.message = message("{}: {}", target.in_sentence(), error.message);
    return fail(std::move(error));
  }
  return Change{node, target, size ? meaning.type : od::DataType::domain, std::move(data)};
}

Result<Value> write_from_file(show::Desk& desk, std::span<const Change> wanted,
                              const std::filesystem::path& file, const WriteOptions& options) {
  const auto changes = changes_with(desk, wanted, options);
  std::vector<session::SdoRequest> requests;
  for (const auto& change : changes)
    requests.push_back({change.node, change.target.address, change.data, change.transfer});
  KeepingNodes keeping(desk, changes);
  if (const auto opened = keeping.open(options); !opened) return fail(opened.error());
  const bool readable = std::all_of(changes.begin(), changes.end(), [](const Change& c) {
    return od::readable(drive::meaning(c.target, c.node).access);
  });
  const auto written = session::write_all(*desk.session, requests, options.keep && readable);
  keeping.close(written);
  auto table = new_table(true);
  table.json_only = std::none_of(written.begin(), written.end(), [](const auto& w) { return w.has_value(); });
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const std::string state(session::state_text(written[i], changes[i].target.address));
    table.rows.push_back(row(desk, changes[i].node, changes[i].target, changes[i].data.size(), file, state,
                             written[i] ? Value() : show::error_record(written[i].error())));
    const auto kept = written[i] ? keeping.kept(changes[i]) : Value();
    table.rows.back().push_back(kept);
    table.rows.back().push_back(written[i] ? kept_text(kept) : Value());
    if (!written[i]) desk.errors.push_back(written[i].error());
  }
  return Value(std::move(table));
}

}  // namespace servoctl::settings
