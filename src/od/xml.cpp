#include "od/xml.hpp"

#include <algorithm>
#include <pugixml.hpp>

#include "base/format.hpp"
#include "base/text.hpp"

namespace servoctl::od {
namespace {

pugi::xml_node node_of(pugi::xml_node_struct* node) { return pugi::xml_node(node); }

std::string_view parse_reason(const pugi::xml_parse_result& result) {
  switch (result.status) {
    case pugi::status_end_element_mismatch: return "an end tag is missing or is not that of its element";
    case pugi::status_bad_start_element: return "a start tag is not complete";
    case pugi::status_bad_end_element: return "an end tag is not complete";
    case pugi::status_bad_attribute: return "an attribute is not complete";
    case pugi::status_bad_comment: return "a comment does not end";
    case pugi::status_bad_cdata: return "a CDATA section does not end";
    case pugi::status_bad_pi: return "an XML declaration or processing instruction does not end";
    case pugi::status_bad_doctype: return "the document type is not complete";
    case pugi::status_bad_pcdata: return "text ends the file";
    case pugi::status_unrecognized_tag: return "a < begins no tag";
    case pugi::status_no_document_element: return "there is no element";
    case pugi::status_out_of_memory: return "there is not enough memory for it";
    default: return "it cannot be read";
  }
}

tl::unexpected<Error> refuse_xml(std::string_view file, TextPlace place, const Message& why) {
  auto error = make_error(
      Errc::file, message("{}:{}:{}: not well-formed XML: {}", as_it_is(file), place.line, place.column, why),
      "is the file whole? get it again from the vendor, or correct this line");
  error.line = place.line;
  return fail(std::move(error));
}

}  // namespace

std::string_view XmlElement::name() const { return node_of(node_).name(); }

std::string_view XmlElement::text() const { return trim(node_of(node_).text().get()); }

std::string_view XmlElement::attribute(const char* name) const {
  return trim(node_of(node_).attribute(name).value());
}

XmlElement XmlElement::child(const char* name) const {
  return {document_, node_of(node_).child(name).internal_object()};
}

std::vector<XmlElement> XmlElement::children(const char* name, std::size_t most) const {
  std::vector<XmlElement> out;
  for (auto node = node_of(node_).child(name); node && out.size() < most; node = node.next_sibling(name))
    out.push_back({document_, node.internal_object()});
  return out;
}

XmlElement XmlElement::parent() const {
  const auto node = node_of(node_).parent();
  return node.type() == pugi::node_element ? XmlElement(document_, node.internal_object()) : XmlElement();
}

TextPlace XmlElement::place() const {
  const auto offset = node_of(node_).offset_debug();
  // The name begins behind the `<`.
  return document_ == nullptr || offset < 1 ? TextPlace{}
                                            : document_->place_at(static_cast<std::size_t>(offset) - 1);
}

XmlDocument::XmlDocument() : document_(std::make_unique<pugi::xml_document>()) {}
XmlDocument::XmlDocument(XmlDocument&&) noexcept = default;
XmlDocument& XmlDocument::operator=(XmlDocument&&) noexcept = default;
XmlDocument::~XmlDocument() = default;

Result<XmlDocument> XmlDocument::parse(std::string_view text, std::string_view file) {
  const auto tags = std::count(text.begin(), text.end(), '<');
  if (static_cast<std::size_t>(tags) > kMostTags)
    return fail(Errc::file,
                message("{}: {} tags are more than any device description has", as_it_is(file), tags),
                message("it may have {}", kMostTags));
  XmlDocument out;
  out.find_lines(text);
  const auto result = out.document_->load_buffer(
      text.data(), text.size(), pugi::parse_default | pugi::parse_doctype, pugi::encoding_utf8);
  if (!result) {
    const auto offset =
        std::min(text.size(), static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0)));
    const bool at_end = trim(text.substr(offset)).size() <= 1;
    return refuse_xml(file, out.place_at(offset),
                      at_end ? "the file ends in the middle" : parse_reason(result));
  }
  for (auto node = out.document_->first_child(); node; node = node.next_sibling())
    out.declares_type_ = out.declares_type_ || node.type() == pugi::node_doctype;
  return out;
}

XmlElement XmlDocument::root() const { return {this, document_->document_element().internal_object()}; }

void XmlDocument::find_lines(std::string_view text) {
  line_starts_.push_back(0);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool pair = text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n';
    if ((text[i] == '\n' || text[i] == '\r') && !pair) line_starts_.push_back(i + 1);
  }
}

TextPlace XmlDocument::place_at(std::size_t offset) const {
  const auto after = std::upper_bound(line_starts_.begin(), line_starts_.end(), offset);
  const auto line = static_cast<std::size_t>(after - line_starts_.begin());
  return {static_cast<std::uint32_t>(line), static_cast<std::uint32_t>(offset - line_starts_[line - 1] + 1)};
}

}  // namespace servoctl::od
