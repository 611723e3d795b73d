// Writes small DICOM files for tests, element by element.
#pragma once

#include <bit>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace voxweld::testing {

// As it stands in the file: transfer syntax, whether elements state their type, byte order.
struct DicomForm {
  std::string syntax = "1.2.840.10008.1.2.1";
  bool explicit_vr = true;
  std::endian order = std::endian::little;
};
inline const DicomForm explicit_little{};
inline const DicomForm implicit_little{"1.2.840.10008.1.2", false, std::endian::little};
inline const DicomForm explicit_big{"1.2.840.10008.1.2.2", true, std::endian::big};

class DicomFile {
 public:
  DicomFile& text(std::uint32_t tag, const std::string& vr, std::string value) {
    if (value.size() % 2 != 0) value += vr == "UI" ? '\0' : ' ';
    elements_[tag] = {vr, std::move(value), false};
    return *this;
  }
  // Binary in the file's byte order, which the writer sees to.
  DicomFile& u16(std::uint32_t tag, unsigned value, const std::string& vr = "US") {
    elements_[tag] = {
        vr, std::string(1, static_cast<char>(value & 0xff)) + static_cast<char>(value >> 8 & 0xff),
        true};
    return *this;
  }
  // Bytes as they stand in the file.
  DicomFile& raw(std::uint32_t tag, const std::string& vr, std::string value) {
    elements_[tag] = {vr, std::move(value), false};
    return *this;
  }
  // Items of compressed samples, with an empty table of offsets before them.
  DicomFile& fragments(const std::vector<std::string>& items) {
    std::string value = item("");
    for (const std::string& bytes : items) value += item(bytes);
    value += std::string("\xfe\xff\xdd\xe0\0\0\0\0", 8);
    elements_[0x7fe00010] = {"OB", std::move(value), false, true};
    return *this;
  }
  DicomFile& drop(std::uint32_t tag) {
    elements_.erase(tag);
    return *this;
  }

  std::string bytes(const DicomForm& form = explicit_little, bool preamble = true) const {
    DicomFile meta;
    meta.text(0x00020010, "UI", form.syntax);
    std::string out = preamble ? std::string(128, '\0') + "DICM" : std::string();
    if (preamble) out += meta.body(explicit_little);
    return out + body(form);
  }

 private:
  struct Element {
    std::string vr, value;
    bool swaps = false, open = false;
  };

  static std::string number(std::uint64_t value, int bytes, std::endian order) {
    std::string out;
    for (int i = 0; i < bytes; ++i)
      out += static_cast<char>(value >> (8 * (order == std::endian::little ? i : bytes - 1 - i)) &
                               0xff);
    return out;
  }
  static std::string item(const std::string& bytes) {
    return std::string("\xfe\xff\x00\xe0", 4) + number(bytes.size(), 4, std::endian::little) +
           bytes;
  }
  std::string body(const DicomForm& form) const {
    std::string out;
    for (const auto& [tag, e] : elements_) {
      std::string value = e.value;
      if (e.swaps && form.order == std::endian::big) std::swap(value[0], value[1]);
      const std::uint64_t length = e.open ? 0xffffffff : value.size();
      out += number(tag >> 16, 2, form.order) + number(tag & 0xffff, 2, form.order);
      const bool is_long = e.vr == "OB" || e.vr == "OW" || e.vr == "SQ" || e.vr == "UN";
      if (form.explicit_vr) out += e.vr + (is_long ? std::string(2, '\0') : std::string());
      out += number(length, form.explicit_vr && !is_long ? 2 : 4, form.order) + value;
    }
    return out;
  }

  std::map<std::uint32_t, Element> elements_;
};

// A CT slice without its samples: 16 bits signed, square samples of 0.5 mm.
struct CtSlice {
  int columns = 1, rows = 1;
  double x = 0, y = 0, z = 0;  // its position
  std::string series = "1.2.3", number = "7";
  int instance = 1;
};
inline std::string position_text(double x, double y, double z) {
  char text[100];
  std::snprintf(text, sizeof text, "%.7g\\%.7g\\%.7g", x, y, z);
  return text;
}
inline DicomFile ct_slice(const CtSlice& s) {
  DicomFile file;
  file.text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\AXIAL")
      .text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2")
      .text(0x00080018, "UI", s.series + "." + std::to_string(s.instance))
      .text(0x00080060, "CS", "CT")
      .text(0x0008103e, "LO", "a ball")
      .text(0x00180050, "DS", "2")
      .text(0x0020000e, "UI", s.series)
      .text(0x00200011, "IS", s.number)
      .text(0x00200013, "IS", std::to_string(s.instance))
      .text(0x00200032, "DS", position_text(s.x, s.y, s.z))
      .text(0x00200037, "DS", "1\\0\\0\\0\\1\\0")
      .u16(0x00280002, 1)
      .text(0x00280004, "CS", "MONOCHROME2")
      .u16(0x00280010, static_cast<unsigned>(s.rows))
      .u16(0x00280011, static_cast<unsigned>(s.columns))
      .text(0x00280030, "DS", "0.5\\0.5")
      .u16(0x00280100, 16)
      .u16(0x00280101, 16)
      .u16(0x00280102, 15)
      .u16(0x00280103, 1)
      .text(0x00281052, "DS", "-1024")
      .text(0x00281053, "DS", "1");
  return file;
}

}  // namespace voxweld::testing
