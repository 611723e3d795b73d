#include "peer_files.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

namespace peers {
namespace {

std::size_t sample_bytes(const Volume& volume) {
  static const std::map<std::string, std::size_t> known = {
      {"uint8", 1}, {"uint16", 2}, {"float", 4}, {"uint32", 4}};
  const auto found = known.find(volume.type);
  return found == known.end() ? 0 : found->second;
}

struct Header {
  Volume volume;
  bool has_isovalue = false, is_below = true, is_plain = true;
};

void take_line(const std::string& line, Header& header) {
  std::istringstream words(line);
  if (line.rfind("# isovalue", 0) == 0) {
    std::string word, side;
    char comma = 0;
    words >> word >> word >> header.volume.isovalue >> comma >> word >> side;
    header.has_isovalue = true;
    header.is_below = side == "below";
  }
  const std::size_t colon = line.find(": ");
  if (line.front() == '#' || colon == std::string::npos) return;
  const std::string key = line.substr(0, colon), value = line.substr(colon + 2);
  if (key == "type") header.volume.type = value;
  if (key == "encoding" || key == "endian")
    header.is_plain = header.is_plain && (value == "raw" || value == "little");
  if (key == "sizes") {
    std::istringstream sizes(value);
    sizes >> header.volume.size[0] >> header.volume.size[1] >> header.volume.size[2];
  }
}

// Of a file whose header has been read.
void take_samples(std::ifstream& file, const std::string& path, Volume& volume) {
  std::size_t bytes = sample_bytes(volume);
  for (const int side : volume.size) bytes *= static_cast<std::size_t>(side);
  volume.samples.resize(bytes);
  file.read(reinterpret_cast<char*>(volume.samples.data()), static_cast<std::streamsize>(bytes));
  if (!file) throw std::runtime_error(path + ": ends before its last sample");
}

Header read_header(std::ifstream& file) {
  Header header;
  std::string line;
  while (std::getline(file, line) && !line.empty()) take_line(line, header);
  header.is_plain = header.is_plain && file && sample_bytes(header.volume) != 0;
  return header;
}

template <class T>
std::vector<std::uint32_t> as_numbers(const Volume& volume) {
  std::vector<std::uint32_t> numbers(volume.samples.size() / sizeof(T));
  const auto* samples = reinterpret_cast<const T*>(volume.samples.data());
  std::copy(samples, samples + numbers.size(), numbers.begin());
  return numbers;
}

}  // namespace

Volume read_volume(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  Header header = read_header(file);
  if (!header.is_plain || !header.has_isovalue || !header.is_below)
    throw std::runtime_error(path +
                             ": expected a phantom as voxweld writes it: NRRD, raw, little-endian, "
                             "uint8, uint16 or float, material below the isovalue in its comment");
  take_samples(file, path, header.volume);
  return std::move(header.volume);
}

Labels read_labels(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  Header header = read_header(file);
  Volume& volume = header.volume;
  if (!header.is_plain || volume.type == "float")
    throw std::runtime_error(
        path + ": expected labels: NRRD, raw, little-endian, uint8, uint16 or uint32");
  take_samples(file, path, volume);
  if (volume.type == "uint8") return {volume.size, as_numbers<std::uint8_t>(volume)};
  if (volume.type == "uint16") return {volume.size, as_numbers<std::uint16_t>(volume)};
  return {volume.size, as_numbers<std::uint32_t>(volume)};
}

void write_ply(const std::string& path, const Mesh& mesh) {
  std::ofstream file(path, std::ios::binary);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.vertices.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
       << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  file.write(reinterpret_cast<const char*>(mesh.vertices.data()),
             static_cast<std::streamsize>(mesh.vertices.size() * sizeof(mesh.vertices[0])));
  constexpr std::size_t face_bytes = 13, at_once = 65536;
  std::vector<char> faces(face_bytes * at_once);
  for (std::size_t first = 0; first < mesh.triangles.size(); first += at_once) {
    const std::size_t end = std::min(first + at_once, mesh.triangles.size());
    char* out = faces.data();
    for (std::size_t i = first; i < end; ++i) {
      *out = 3;
      std::memcpy(out + 1, mesh.triangles[i].data(), sizeof(mesh.triangles[i]));
      out += face_bytes;
    }
    file.write(faces.data(), out - faces.data());
  }
  if (!file.flush()) throw std::runtime_error(path + ": cannot write");
}

void print_figures(const Seconds& seconds, std::size_t triangles, const std::string& library) {
  std::printf(
      "{\"library\": \"%s\", \"triangles\": %zu, \"reading_s\": %.4f, \"meshing_s\": %.4f, "
      "\"writing_s\": %.4f}\n",
      library.c_str(), triangles, seconds.reading, seconds.meshing, seconds.writing);
}

double number_argument(int argc, char** argv, int at, double otherwise) {
  return at < argc ? std::strtod(argv[at], nullptr) : otherwise;
}

}  // namespace peers
