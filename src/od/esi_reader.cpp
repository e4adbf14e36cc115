#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/text.hpp"
#include "od/eds_value.hpp"
#include "od/esi.hpp"
#include "od/esi_checks.hpp"
#include "od/esi_layout.hpp"
#include "od/esi_objects.hpp"
#include "od/esi_value.hpp"
#include "od/text_encoding.hpp"
#include "od/xml.hpp"

namespace servoctl::od {
namespace {

constexpr const char* kEsiHint = "an ESI file of an EtherCAT device (ETG.2000) begins with <EtherCATInfo>";

constexpr std::size_t kMostDevices = 4096;
constexpr std::size_t kMostListed = 20;  ///< In an error.

tl::unexpected<Error> refuse_esi(std::string_view file, const Message& why, Message hint = kEsiHint) {
  return fail(Errc::file, message("{}: {}", as_it_is(file), why), std::move(hint));
}

/// The encoding that the XML declaration names; empty where it names none that is known here.
std::optional<TextEncoding> declared_encoding(std::string_view bytes) {
  struct Row {
    std::string_view name;
    TextEncoding encoding;
  };
  constexpr std::array kRows{Row{"utf-8", TextEncoding::utf8},
                             Row{"gb2312", TextEncoding::gbk},
                             Row{"gbk", TextEncoding::gbk},
                             Row{"gb18030", TextEncoding::gbk},
                             Row{"big5", TextEncoding::cp950},
                             Row{"shift_jis", TextEncoding::cp932},
                             Row{"iso-8859-1", TextEncoding::cp1252},
                             Row{"windows-1252", TextEncoding::cp1252},
                             Row{"windows-1251", TextEncoding::cp1251}};
  constexpr std::string_view kKey = "encoding=";
  const auto head = bytes.substr(0, std::min(bytes.find("?>"), std::size_t{200}));
  const auto at = head.find(kKey);
  if (!head.starts_with("<?xml") || at == std::string_view::npos) return std::nullopt;
  auto name = trim(head.substr(at + kKey.size()));
  if (name.empty()) return std::nullopt;
  const auto quote = name.front();
  name.remove_prefix(1);
  name = name.substr(0, name.find(quote));
  for (const auto& row : kRows)
    if (equals_nocase(row.name, name)) return row.encoding;
  return std::nullopt;
}

/// What the bytes prove (a mark, valid UTF-8) goes before what is declared, that before a guess.
DecodedText decode_xml(std::string_view bytes, Findings& findings) {
  const auto guess = guess_encoding(bytes);
  const bool proven =
      guess == TextEncoding::utf8 || guess == TextEncoding::utf16le || guess == TextEncoding::utf16be;
  const auto declared = declared_encoding(bytes);
  const bool as_declared =
      !proven && declared && *declared != TextEncoding::utf8 && means_something(bytes, *declared);
  auto out = to_utf8(bytes, as_declared ? *declared : guess);
  if (!proven && !as_declared)
    findings.add(Severity::warning, out.line, out.column, "encoding",
                 formatted("the file is taken as {}, {}", title(out.encoding),
                           declared ? "which is not what it declares" : "as it declares no encoding"),
                 "save it as UTF-8");
  if (out.skipped_nuls > 0)
    findings.add(Severity::warning, out.line, out.column, "nul-byte",
                 formatted("{} NUL bytes are skipped", out.skipped_nuls), "remove them");
  return out;
}

std::string_view what_else(std::string_view root) {
  if (root == "ISO15745ProfileContainer" || root == "ISO15745Profile")
    return "it is a device description of CiA 311 (XDD or XDC), which is not supported: use the device's EDS";
  if (root == "EtherCATConfig")
    return "it is the configuration of a network (ENI): use the ESI file of the device";
  if (root == "EtherCATModule" || root == "EtherCATDiag" || root == "EtherCATDict")
    return "it is a part of an ESI: use the file that has the devices";
  return kEsiHint;
}

/// An ESI text with its devices; their elements point into the document.
struct OpenedEsi {
  Findings findings;
  std::unique_ptr<XmlDocument> document;
  std::vector<XmlElement> devices;
  std::map<std::string, std::string, std::less<>> groups;  ///< Their names in English.
};

EsiDevice device_of(const OpenedEsi& opened, XmlElement element, EsiFindings& findings) {
  EsiDevice out;
  const auto type = element.child("Type");
  out.type = std::string(type.text());
  out.product_code = static_cast<std::uint32_t>(esi_attribute(type, "ProductCode", 0xFFFF'FFFF, findings));
  out.revision = static_cast<std::uint32_t>(esi_attribute(type, "RevisionNo", 0xFFFF'FFFF, findings));
  auto name = esi_text(element, "Name");
  out.name = name.english.empty() ? out.type : std::move(name.english);
  out.name_zh = std::move(name.chinese);
  const auto group = element.child("GroupType").text();
  const auto known = opened.groups.find(group);
  out.group = known == opened.groups.end() ? std::string(group) : known->second;
  out.line = element.place().line;
  return out;
}

Result<OpenedEsi> open_esi(std::string_view bytes, std::string_view file) {
  OpenedEsi out;
  if (bytes.size() > kMostEsiBytes)
    return refuse_esi(file, message("{} MiB is too large for an ESI", bytes.size() >> 20U));
  if (is_binary(bytes)) return refuse_esi(file, "not a text file");
  const auto decoded = decode_xml(bytes, out.findings);
  const auto text = decoded.text(bytes);
  if (!starts_with_nocase(trim(text.substr(0, 256)), "<")) return refuse_esi(file, "this is not XML");
  auto document = XmlDocument::parse(text, file);
  if (!document) return fail(document.error());
  out.document = std::make_unique<XmlDocument>(std::move(*document));
  const auto root = out.document->root();
  if (root.name() != "EtherCATInfo")
    return refuse_esi(file, message("<{}> is not an ESI", shown(root.name())),
                      std::string(what_else(root.name())));
  if (out.document->declares_type())
    out.findings.add(Severity::warning, 1, 1, "document-type",
                     "the document type is not read; entities it defines stay as they are",
                     "remove the DOCTYPE");
  const auto descriptions = root.child("Descriptions");
  for (const auto& group : descriptions.child("Groups").children("Group"))
    if (auto words = esi_text(group, "Name"); !words.english.empty())
      out.groups.emplace(std::string(group.child("Type").text()), std::move(words.english));
  out.devices = descriptions.child("Devices").children("Device", kMostDevices + 1);
  if (out.devices.size() > kMostDevices)
    return refuse_esi(file, message("more than {} devices are in this file", kMostDevices),
                      "use a file of fewer");
  if (out.devices.empty())
    return refuse_esi(file, "there is no Device in this file",
                      "an ESI of modules or of a group describes no device");
  return out;
}

/// Product code, and the revision where the device shares it with others: `0x000C010D:0x00010000`.
std::string listed(const std::vector<EsiDevice>& devices) {
  std::string out;
  for (std::size_t i = 0; i < std::min(devices.size(), kMostListed); ++i)
    append(out,
           formatted("#{} {} (product code 0x{:08X}, revision 0x{:08X})", i + 1, shown(devices[i].name),
                     devices[i].product_code, devices[i].revision),
           "; ");
  if (devices.size() > kMostListed) out += formatted("; {} more", devices.size() - kMostListed);
  return out;
}

bool is_meant(const EsiDevice& device, std::string_view word) {
  if (equals_nocase(device.type, word) || equals_nocase(device.name, word)) return true;
  const auto colon = word.find(':');
  const auto code = esi_integer(word.substr(0, colon));
  if (!code || code->magnitude != device.product_code) return false;
  if (colon == std::string_view::npos) return true;
  const auto revision = esi_integer(word.substr(colon + 1));
  return revision && revision->magnitude == device.revision;
}

/// The place of the device that is meant.
Result<std::size_t> choose(const std::vector<EsiDevice>& devices, std::string_view file,
                           std::string_view word) {
  if (word.empty() && devices.size() == 1) return std::size_t{0};
  const auto hint = [&](std::string_view start) {
    return message("{} {}#NUMBER, #NAME or #PRODUCT_CODE:REVISION: {}", start, as_it_is(file),
                   listed(devices));
  };
  if (word.empty())
    return fail(Errc::usage, message("{} describes {} devices: which one?", as_it_is(file), devices.size()),
                hint("write"));
  if (const auto number = parse_digits(word, 10); number && *number >= 1 && *number <= devices.size())
    return static_cast<std::size_t>(*number - 1);
  std::vector<std::size_t> meant;
  for (std::size_t i = 0; i < devices.size(); ++i)
    if (is_meant(devices[i], word)) meant.push_back(i);
  if (meant.size() == 1) return meant.front();
  return fail(Errc::usage,
              meant.empty()
                  ? message("{} has no device '{}'", as_it_is(file), as_it_is(shown(word)))
                  : message("{} has {} devices '{}'", as_it_is(file), meant.size(), as_it_is(shown(word))),
              hint("write"));
}

void take_device_info(XmlElement root, EsiFile& out, EsiFindings& findings) {
  const auto vendor = root.child("Vendor");
  auto& info = out.sheet.device;
  info.vendor_name = esi_text(vendor, "Name").english;
  info.vendor_number = static_cast<std::uint32_t>(esi_number(vendor.child("Id"), 0xFFFF'FFFF, findings));
  info.product_name = out.device.name;
  info.product_number = out.device.product_code;
  info.revision_number = out.device.revision;
  out.sheet.ethercat = true;
}

/// The first Dictionary among the profiles of a device.
void read_dictionary(XmlElement device, Dictionary& dictionary, BitSizes& sizes, EsiFindings& findings) {
  bool has_dictionary = false;
  for (const auto& profile : device.children("Profile")) {
    if (const auto other = profile.child("DictionaryFile"))
      findings.warn(
          other, "dictionary-elsewhere",
          formatted("its dictionary is in another file, '{}', which is not read", shown(other.text())),
          "put the Dictionary into this file");
    const auto own = profile.child("Dictionary");
    if (!own) continue;
    if (has_dictionary)
      findings.warn(own, "second-dictionary", "the device has a second Dictionary; the first one is used",
                    "join them");
    else
      read_esi_objects(own, dictionary, sizes, findings);
    has_dictionary = true;
  }
}

/// One device of a file that is open; `findings` are those of the file as a whole.
Result<EsiFile> read_device(const OpenedEsi& opened, std::size_t number, std::string_view file) {
  Findings all = opened.findings;
  EsiFindings findings(all);
  const auto root = opened.document->root();
  const auto element = opened.devices[number];
  EsiFile out;
  out.number = number + 1;
  out.devices = opened.devices.size();
  out.device = device_of(opened, element, findings);
  take_device_info(root, out, findings);
  out.layout = read_esi_layout(element, findings);
  BitSizes sizes;
  read_dictionary(element, out.sheet.dictionary, sizes, findings);
  const bool has_dictionary = !out.sheet.dictionary.empty();
  check_esi_layout(out, sizes, has_dictionary, all);
  add_esi_pdos(out.layout, has_dictionary, out.sheet.dictionary);
  if (!has_dictionary)
    findings.warn(element, "no-dictionary",
                  "the device has no object dictionary; what its PDOs carry is all that is known",
                  "ask the vendor for an ESI with the dictionary, or use an EDS");
  settle_esi_identity(out, all);
  out.sheet.diagnostics = all.take();
  if (!out.sheet.dictionary.empty()) return out;
  const auto& found = out.sheet.diagnostics;
  const auto why = std::find_if(found.begin(), found.end(),
                                [](const Diagnostic& d) { return d.severity == Severity::error; });
  return refuse_esi(
      file, message("'{}' has neither a usable object nor a PDO entry", as_it_is(shown(out.device.name))),
      why == found.end() ? std::string("it cannot be commissioned by objects: is it a coupler or a junction?")
                         : to_string(*why, file));
}

}  // namespace

Result<EsiFile> read_esi(std::string_view bytes, std::string_view file, std::string_view device) {
  const auto opened = open_esi(bytes, file);
  if (!opened) return fail(opened.error());
  Findings ignored;  // read_device() tells them.
  EsiFindings findings(ignored);
  std::vector<EsiDevice> devices;
  for (const auto& element : opened->devices) devices.push_back(device_of(*opened, element, findings));
  const auto number = choose(devices, file, device);
  if (!number) return fail(number.error());
  return read_device(*opened, *number, file);
}

Result<std::vector<EsiFile>> read_all_esi(std::string_view bytes, std::string_view file) {
  const auto opened = open_esi(bytes, file);
  if (!opened) return fail(opened.error());
  std::vector<EsiFile> out;
  for (std::size_t number = 0; number < opened->devices.size(); ++number) {
    auto read = read_device(*opened, number, file);
    if (!read && opened->devices.size() == 1) return fail(read.error());
    if (read) out.push_back(std::move(*read));
  }
  if (out.empty())
    return refuse_esi(file, "none of its devices has a usable object",
                      "is it a file of couplers or terminals?");
  return out;
}

}  // namespace servoctl::od
