// What a glTF says of labels: as other programs read it.
#include "stages/encode/glb_pairs.h"

#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "stages/encode/glb.h"
#include "storage/support/file_io.h"
#include "tests/stages/encode/pair_book.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using testing::book;
using testing::document_of;
using testing::gltf_formats;
using testing::view_of;
using testing::with_pairs;
using testing::written;

TEST(GlbPairs, AreFeaturesOfOnePrimitive) {
  for (const int sheets : {3, 300})
    for (const char* format : gltf_formats) {
      const auto glb = written(format, book(sheets, 4), {});
      const nlohmann::json doc = document_of(glb);
      const bool draco = std::string(format) == "glb";
      ASSERT_EQ(doc["meshes"][0]["primitives"].size(), 1u);
      const auto& primitive = doc["meshes"][0]["primitives"][0];
      EXPECT_EQ(primitive["extensions"]["EXT_mesh_features"]["featureIds"],
                nlohmann::json::array(
                    {{{"featureCount", sheets}, {"attribute", 0}, {"propertyTable", 0}}}));
      std::vector<std::string> used = {"EXT_mesh_features", "EXT_structural_metadata"};
      if (draco) used.insert(used.begin(), "KHR_draco_mesh_compression");
      EXPECT_EQ(doc["extensionsUsed"], used);
      EXPECT_EQ(doc.contains("extensionsRequired"), draco);
      const auto& ids =
          doc["accessors"][primitive["attributes"]["_FEATURE_ID_0"].get<std::size_t>()];
      EXPECT_EQ(ids["type"], "SCALAR");
      EXPECT_EQ(ids["componentType"], !draco ? 5126 : sheets <= 256 ? 5121 : 5123);
      EXPECT_TRUE(doc["materials"][0]["doubleSided"]);
      EXPECT_EQ(doc["materials"].size(), 1u);
      // Columns of 64 bits lie at multiples of 8 in the file.
      EXPECT_EQ((glb.size() - doc["buffers"][0]["byteLength"].get<std::size_t>()) % 8, 0u);
      EXPECT_EQ(glb.size() % 8, 0u);
    }
}

// What other programs read of the table, column by column.
TEST(GlbPairs, AreRowsOfATable) {
  MaterialTable table;
  table.entries = {
      {0, "left \u00e9", MaterialColor{255, 0, 188}}, {1, "", std::nullopt}, {2, "two", {}}};
  TileMesh mesh = book(3, 4);
  mesh.pairs = {{0, exterior}, {0, 2}, {1, 130}};
  for (const char* format : gltf_formats) {
    const auto glb = written(format, mesh, testing::facts_of(true, &table));
    const nlohmann::json doc = document_of(glb);
    const auto& metadata = doc["extensions"]["EXT_structural_metadata"];
    const auto& rows = metadata["propertyTables"][0];
    EXPECT_EQ(rows["count"], 3);
    const auto& schema =
        metadata["schema"]["classes"][rows["class"].get<std::string>()]["properties"];
    const auto column = [&](const char* name, const char* part = "values") {
      return view_of(glb, doc, rows["properties"][name][part]);
    };
    using namespace std::string_literals;
    EXPECT_EQ(schema["inside"]["componentType"], "INT16");
    EXPECT_EQ(schema["inside"]["noData"], -1);
    EXPECT_EQ(column("inside"), "\0\0\0\0\1\0"s);
    EXPECT_EQ(column("outside"), "\xff\xff\2\0\x82\0"s);
    EXPECT_EQ(column("inside_name"), "left \u00e9left \u00e9");
    EXPECT_EQ(column("inside_name", "stringOffsets"), "\0\0\0\0\7\0\0\0\16\0\0\0\16\0\0\0"s);
    EXPECT_EQ(column("outside_name"), "two");
    EXPECT_EQ(column("inside_color").substr(0, 6), "\xff\0\xbc\xff\0\xbc"s);
    EXPECT_EQ(column("outside_color").substr(0, 3), "\xff\xff\xff"s);
    for (const auto& [name, property] : rows["properties"].items()) {
      EXPECT_TRUE(schema.contains(name));
      for (const auto& [part, view] : property.items())
        EXPECT_EQ(doc["bufferViews"][view.get<std::size_t>()]["byteOffset"].get<int>() % 8, 0);
    }
    EXPECT_EQ(decode_glb(glb).pairs, mesh.pairs);
  }
  // Without names there are no columns of them.
  const auto plain = document_of(written("glb", mesh, {}));
  EXPECT_FALSE(
      plain["extensions"]["EXT_structural_metadata"]["propertyTables"][0]["properties"].contains(
          "inside_name"));
}

TEST(GlbPairs, HaveLabelsOfAnySize) {
  TileMesh mesh = book(2, 4);
  const std::pair<Material, const char*> highest[] = {{127, "INT8"},
                                                      {128, "INT16"},
                                                      {32767, "INT16"},
                                                      {32768, "INT32"},
                                                      {0x7fffffff, "INT32"},
                                                      {0x80000000, "INT64"},
                                                      {0x7fffffffffffffff, "INT64"},
                                                      {0x8000000000000000, "UINT64"},
                                                      {testing::high_label, "UINT64"}};
  for (const auto& [label, type] : highest) {
    mesh.pairs = {{3, label}, {label, exterior}};
    const auto glb = written("glb-plain", mesh, {});
    EXPECT_EQ(decode_glb(glb).pairs, mesh.pairs) << label;
    EXPECT_EQ(document_of(glb)["extensions"]["EXT_structural_metadata"]["schema"]["classes"]
                              ["label_pair"]["properties"]["outside"]["componentType"],
              type);
  }
}

// Those of a table are sRGB, those of points and materials linear.
TEST(GlbPairs, HaveTheColoursTheirLabelsAreGiven) {
  MaterialTable table;
  table.entries = {{0, "first", MaterialColor{255, 0, 188}}, {1, "second", std::nullopt}};
  const TileMesh mesh = book(3, 4);
  const auto colours = [&](const MaterialTable* materials) {
    const auto glb = written("glb-plain", mesh, testing::facts_of(true, materials));
    const nlohmann::json doc = document_of(glb);
    const auto& attributes = doc["meshes"][0]["primitives"][0]["attributes"];
    const auto& accessor = doc["accessors"][attributes["COLOR_0"].get<std::size_t>()];
    EXPECT_EQ(accessor["normalized"], true);
    const std::string levels = view_of(glb, doc, accessor["bufferView"]);
    const DecodedMesh read = decode_glb(glb);
    std::vector<std::string> of_pair(3);
    for (std::size_t t = 0; t < read.triangles.size(); ++t)
      for (const std::uint32_t point : read.triangles[t]) {
        const std::string colour = levels.substr(std::size_t{4} * point, 4);
        std::string& known = of_pair[read.triangle_pairs[t]];
        EXPECT_TRUE(known.empty() || known == colour);
        known = colour;
      }
    return of_pair;
  };
  const auto given = colours(&table), by_number = colours(nullptr);
  EXPECT_EQ(given[0], std::string("\xff\0\x80\xff", 4));
  EXPECT_EQ(given[1], by_number[1]);  // of label 1, which has none
  EXPECT_NE(given[0], by_number[0]);
  EXPECT_NE(by_number[0], by_number[1]);
}

// What viewers take from the Draco buffer has the types that the accessors state, and the colours of the
// file without compression.
TEST(GlbPairs, AreInTheDracoBufferAsStated) {
  for (const int sheets : {3, 300}) {
    const TileMesh mesh = book(sheets, 4);
    const auto glb = written("glb", mesh, {});
    const nlohmann::json doc = document_of(glb);
    const auto& primitive = doc["meshes"][0]["primitives"][0];
    const auto& how = primitive["extensions"]["KHR_draco_mesh_compression"];
    const std::string bytes = view_of(glb, doc, how["bufferView"]);
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    const auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    ASSERT_TRUE(decoded.ok());
    const draco::Mesh& found = *decoded.value();
    ASSERT_EQ(how["attributes"].size(), 4u);
    const auto attribute = [&](const char* name) -> const draco::PointAttribute& {
      return *found.GetAttributeByUniqueId(how["attributes"][name].get<std::uint32_t>());
    };
    const std::map<draco::DataType, int> components = {
        {draco::DT_UINT8, 5121}, {draco::DT_UINT16, 5123}, {draco::DT_FLOAT32, 5126}};
    const std::map<std::string, int> shapes = {{"SCALAR", 1}, {"VEC3", 3}, {"VEC4", 4}};
    for (const auto& [name, number] : primitive["attributes"].items()) {
      const auto& accessor = doc["accessors"][number.get<std::size_t>()];
      EXPECT_EQ(components.at(attribute(name.c_str()).data_type()), accessor["componentType"]);
      EXPECT_EQ(attribute(name.c_str()).num_components(), shapes.at(accessor["type"]));
      EXPECT_EQ(accessor["count"], found.num_points());
    }
    const auto colours = glb::pair_colours(mesh.pairs, nullptr);
    for (draco::PointIndex point(0); point < found.num_points(); ++point) {
      std::uint32_t id = 0;
      PairColour colour{};
      attribute("_FEATURE_ID_0").ConvertValue(attribute("_FEATURE_ID_0").mapped_index(point), &id);
      attribute("COLOR_0").GetMappedValue(point, colour.data());
      EXPECT_EQ(colour, colours.at(id));
    }
  }
}

// A mesh that is one label's has its name and colour, and none otherwise.
TEST(GlbPairs, AFileOfOneLabelIsNamedForIt) {
  MaterialTable table;
  table.entries = {{0, "first", MaterialColor{255, 0, 188}}, {1, "", std::nullopt}};
  TileMesh mesh = book(1, 4);
  mesh.pairs.clear();
  mesh.triangle_pairs.clear();
  AssetFacts facts = testing::facts_of(true, &table);
  const auto doc_of = [&](const char* format, Material label) {
    facts.label = label;
    return document_of(written(format, mesh, facts));
  };
  for (const char* format : gltf_formats) {
    const auto first = doc_of(format, 0), second = doc_of(format, 1),
               none = doc_of(format, exterior);
    EXPECT_EQ(first["nodes"][0]["name"], "first");
    EXPECT_EQ(first["meshes"][0]["name"], "first");
    EXPECT_EQ(first["nodes"][0]["extras"]["label"], 0);
    for (const auto& doc : {second, none}) {
      EXPECT_FALSE(doc["nodes"][0].contains("name"));
      EXPECT_FALSE(doc["meshes"][0].contains("name"));
      EXPECT_FALSE(doc["nodes"][0].contains("extras"));
    }
    EXPECT_FALSE(first.contains("extensions"));
    const auto colour = [](const nlohmann::json& doc) {
      return doc["materials"][0]["pbrMetallicRoughness"].value("baseColorFactor", nlohmann::json());
    };
    EXPECT_EQ(colour(first), (nlohmann::json{1.0, 0.0, 0.50289, 1.0}));
    EXPECT_TRUE(colour(second).is_null());
    EXPECT_TRUE(colour(none).is_null());
  }
}

// Past 2^16 pairs feature ids are floats, which Draco has to give back as they were.
TEST(GlbPairs, OfMoreThanSixteenBitsAreWholeNumbers) {
  TileMesh mesh = testing::make_torus({.around = 300, .across = 150}, testing::small_lattice());
  for (std::uint32_t i = 0; i < 70000; ++i) mesh.pairs.push_back({i, i + 1});
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
    mesh.triangle_pairs.push_back(i % 70000);
  const auto glb = written("glb", mesh, {});
  EXPECT_EQ(document_of(glb)["accessors"][3]["componentType"], 5126);
  EXPECT_EQ(digest(weld(decode_glb(glb), mesh.lattice)), digest(with_pairs(mesh)));
}

TEST(GlbPairs, TheKhronosValidatorFindsNoFault) {
  const std::string script = VOXWELD_GLTF_VALIDATE;
  if (std::system(fmt::format("node {} > /dev/null 2>&1", script).c_str()) != 0)
    GTEST_SKIP() << "gltf-validator is not installed; run tests/npm_packages.sh";
  MaterialTable table;
  table.entries = {{0, "first", MaterialColor{255, 0, 188}}, {1, "second", std::nullopt}};
  const testing::TempDirectory directory;
  std::string files;
  for (const char* format : gltf_formats)
    for (const int sheets : {1, 3, 300})
      for (const bool normals : {false, true}) {
        const auto path = directory / fmt::format("{}.glb", files.size());
        write_whole_file(path, written(format, book(sheets, 3), testing::facts_of(normals, &table)),
                         Durability::rename_only);
        files += fmt::format(" {}", path.string());
      }
  EXPECT_EQ(std::system(fmt::format("node {}{}", script, files).c_str()), 0);
}

}  // namespace
}  // namespace voxweld
