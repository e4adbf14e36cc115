#include "od/eds_writer.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "base/format.hpp"
#include "base/number.hpp"
#include "base/pdo_index.hpp"
#include "base/text.hpp"
#include "od/eds_value.hpp"

namespace servoctl::od {
namespace {

/// Which list of a file an object belongs to (CiA 306-1, 4.6.1).
enum class ObjectList : std::uint8_t { mandatory, optional, manufacturer };

ObjectList list_of(std::uint16_t index) {
  if (index == 0x1000 || index == 0x1001 || index == 0x1018) return ObjectList::mandatory;
  return index >= 0x2000 && index < 0x6000 ? ObjectList::manufacturer : ObjectList::optional;
}

std::string default_text(const Entry& entry, const NodeValue& value) {
  const auto* number = std::get_if<std::uint64_t>(&value.value);
  if (value.plus_node_id && number != nullptr) return formatted("$NODEID+0x{:X}", *number);
  const auto text = eds_text(entry.type, value.value);
  return value.plus_node_id ? "$NODEID+" + text : text;
}

class EdsWriter {
 public:
  EdsWriter(const EdsHead& head, const DeviceInfo& device, const Dictionary& dictionary)
      : head_(&head), device_(&device), dictionary_(&dictionary) {}

  std::string write() {
    add_file();
    add_device();
    add_comments();
    add_list("MandatoryObjects", ObjectList::mandatory);
    add_list("OptionalObjects", ObjectList::optional);
    add_list("ManufacturerObjects", ObjectList::manufacturer);
    for (const auto& object : dictionary_->objects()) add_object(object);
    return std::move(out_);
  }

 private:
  void add_file() {
    begin("FileInfo");
    line("FileName", head_->file_name);
    line("FileVersion", "1");
    line("FileRevision", "0");
    line("EDSVersion", "4.0");
    line("Description", head_->description);
    for (const std::string_view what : {"Creation", "Modification"}) {
      line(formatted("{}Time", what), head_->time);
      line(formatted("{}Date", what), head_->date);
    }
    line("CreatedBy", "servoctl");
    line("ModifiedBy", "servoctl");
  }

  void add_device() {
    begin("DeviceInfo");
    line("VendorName", device_->vendor_name);
    line("VendorNumber", formatted("0x{:X}", device_->vendor_number));
    line("ProductName", device_->product_name);
    line("ProductNumber", formatted("0x{:X}", device_->product_number));
    line("RevisionNumber", formatted("0x{:X}", device_->revision_number));
    line("OrderCode", "");
    for (const auto rate : device_->bitrates) line(formatted("BaudRate_{}", rate), "1");
    line("SimpleBootUpMaster", "0");
    line("SimpleBootUpSlave", "1");
    line("Granularity", "8");
    line("DynamicChannelsSupported", "0");
    line("GroupMessaging", "0");
    line("NrOfRXPDO", formatted("{}", count_pdos(PdoDirection::receive)));
    line("NrOfTXPDO", formatted("{}", count_pdos(PdoDirection::transmit)));
    line("LSS_Supported", "0");
  }

  std::size_t count_pdos(PdoDirection direction) const {
    const auto& objects = dictionary_->objects();
    return static_cast<std::size_t>(std::count_if(objects.begin(), objects.end(), [&](const Object& object) {
      const auto place = pdo_at(object.index);
      return place && !place->mapping && place->direction == direction;
    }));
  }

  void add_comments() {
    if (head_->comments.empty()) return;
    begin("Comments");
    line("Lines", formatted("{}", head_->comments.size()));
    for (std::size_t i = 0; i < head_->comments.size(); ++i)
      line(formatted("Line{}", i + 1), head_->comments[i]);
  }

  void add_list(std::string_view name, ObjectList list) {
    std::vector<std::uint16_t> indexes;
    for (const auto& object : dictionary_->objects())
      if (list_of(object.index) == list) indexes.push_back(object.index);
    begin(name);
    line("SupportedObjects", formatted("{}", indexes.size()));
    for (std::size_t i = 0; i < indexes.size(); ++i)
      line(formatted("{}", i + 1), formatted("0x{:04X}", indexes[i]));
  }

  void add_object(const Object& object) {
    begin(formatted("{:04X}", object.index));
    line("ParameterName", object.name);
    line("ObjectType", formatted("0x{:X}", static_cast<unsigned>(object.code)));
    if (object.code != ObjectCode::array && object.code != ObjectCode::record) {
      if (!object.entries.empty()) add_values(object.entries.front());
      return;
    }
    line("SubNumber", formatted("{}", object.entries.size()));
    for (const auto& entry : object.entries) {
      begin(formatted("{:04X}sub{:X}", object.index, entry.address.sub));
      line("ParameterName", entry.name);
      line("ObjectType", "0x7");
      add_values(entry);
    }
  }

  void add_values(const Entry& entry) {
    line("DataType", formatted("0x{:04X}", cia_code(entry.type)));
    line("AccessType", name(entry.access));
    if (entry.default_value) line("DefaultValue", default_text(entry, *entry.default_value));
    if (entry.low) line("LowLimit", default_text(entry, *entry.low));
    if (entry.high) line("HighLimit", default_text(entry, *entry.high));
    line("PDOMapping", entry.pdo == PdoMapping::no ? "0" : "1");
  }

  void begin(std::string_view section) { out_ += formatted("{}[{}]\n", out_.empty() ? "" : "\n", section); }
  /// A line break would begin another key.
  void line(std::string_view key, std::string_view value) {
    std::string text(value);
    std::replace_if(
        text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
    out_ += formatted("{}={}\n", key, trim(text));
  }

  const EdsHead* head_;
  const DeviceInfo* device_;
  const Dictionary* dictionary_;
  std::string out_;
};

}  // namespace

EdsTime eds_time(std::string_view iso) {
  const auto hour = iso.size() < 16 ? std::nullopt : parse_digits(iso.substr(11, 2), 10);
  if (!hour) return {};
  return {formatted("{}-{}-{}", iso.substr(5, 2), iso.substr(8, 2), iso.substr(0, 4)),
          formatted("{:02}:{}{}", (*hour + 11) % 12 + 1, iso.substr(14, 2), *hour < 12 ? "AM" : "PM")};
}

std::string write_eds(const EdsHead& head, const DeviceInfo& device, const Dictionary& dictionary) {
  return EdsWriter(head, device, dictionary).write();
}

}  // namespace servoctl::od
