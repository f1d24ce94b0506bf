// The interface beside the one that was last released: clients that were made for that one must go on working.

#include "api_changes.hpp"

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <functional>

#include "support/process.hpp"

namespace planemap {
namespace {

using google::protobuf::FileDescriptorProto;
using google::protobuf::FileDescriptorSet;

/// As protoc writes it: docs/api.md says how.
FileDescriptorSet released() {
  FileDescriptorSet files;
  const std::string text = read_file(PLANEMAP_SOURCE_DIR "/service/api/planemap_v1.released.txtpb");
  if (!google::protobuf::TextFormat::ParseFromString(text, &files)) throw std::runtime_error("no released interface");
  return files;
}

FileDescriptorSet present() {
  FileDescriptorSet files;
  if (!files.ParseFromString(read_file(PLANEMAP_API_DESCRIPTORS))) throw std::runtime_error("no descriptors");
  return files;
}

FileDescriptorProto& file_of(FileDescriptorSet& files, const std::string& name) {
  for (auto& file : *files.mutable_file()) {
    if (file.name() == name) return file;
  }
  throw std::runtime_error(name + " is not in the set");
}

TEST(Api, BreaksNothingThatWasReleased) {
  const auto before = released();
  ASSERT_EQ(before.file_size(), 7);
  EXPECT_EQ(breaking_changes(before, present()), std::vector<std::string>{});
}

TEST(Api, EachKindOfBreakIsFound) {
  using Change = std::function<void(FileDescriptorSet&)>;
  const auto planes = [](FileDescriptorSet& files) -> FileDescriptorProto& {
    return file_of(files, "planemap/v1/planes.proto");
  };
  const auto service = [](FileDescriptorSet& files) -> FileDescriptorProto& {
    return file_of(files, "planemap/v1/planemap_service.proto");
  };
  const std::pair<Change, const char*> cases[] = {
      {[&](auto& f) { planes(f).mutable_message_type(0)->mutable_field()->RemoveLast(); },
       "planemap.v1.Vector3: field 3 (z: TYPE_DOUBLE) has gone"},
      {[&](auto& f) { planes(f).mutable_message_type(0)->mutable_field(2)->set_number(9); },
       "planemap.v1.Vector3: field 3 (z: TYPE_DOUBLE) has gone"},
      {[&](auto& f) {
         planes(f).mutable_message_type(0)->mutable_field(2)->set_type(
             google::protobuf::FieldDescriptorProto::TYPE_FLOAT);
       },
       "planemap.v1.Vector3: field 3 was 'z: TYPE_DOUBLE', is 'z: TYPE_FLOAT'"},
      {[&](auto& f) {
         planes(f).mutable_message_type(0)->mutable_field(2)->set_label(
             google::protobuf::FieldDescriptorProto::LABEL_REPEATED);
       },
       "planemap.v1.Vector3: field 3 was 'z: TYPE_DOUBLE', is 'z: TYPE_DOUBLE repeated'"},
      {[&](auto& f) { planes(f).mutable_message_type(0)->mutable_field(2)->set_name("w"); },
       "planemap.v1.Vector3: field 3 was 'z: TYPE_DOUBLE', is 'w: TYPE_DOUBLE'"},
      {[&](auto& f) { planes(f).mutable_message_type(0)->set_name("Vector"); }, "planemap.v1.Vector3: has gone"},
      {[&](auto& f) { planes(f).mutable_enum_type(0)->mutable_value(1)->set_name("PLANE_CLASS_GROUND"); },
       "planemap.v1.PlaneClass: value 1 was 'PLANE_CLASS_FLOOR', is 'PLANE_CLASS_GROUND'"},
      {[&](auto& f) { service(f).mutable_service(0)->mutable_method(0)->set_server_streaming(false); },
       "planemap.v1.PlaneMap: call GetSnapshot was '.planemap.v1.GetSnapshotRequest -> stream "
       ".planemap.v1.SnapshotPage', is '.planemap.v1.GetSnapshotRequest -> .planemap.v1.SnapshotPage'"},
      {[&](auto& f) { service(f).mutable_service(0)->mutable_method()->RemoveLast(); },
       "planemap.v1.PlaneMap: call GetStatus (.planemap.v1.GetStatusRequest -> .planemap.v1.GetStatusResponse) has "
       "gone"},
  };
  for (const auto& [change, words] : cases) {
    auto after = present();
    change(after);
    const auto changes = breaking_changes(present(), after);
    ASSERT_EQ(changes.size(), 1u) << words;
    EXPECT_EQ(changes[0], words);
  }
}

TEST(Api, WhatIsNewBreaksNothing) {
  auto after = present();
  auto& file = file_of(after, "planemap/v1/planes.proto");
  auto& field = *file.mutable_message_type(0)->add_field();
  field.set_name("extra");
  field.set_number(77);
  file.add_message_type()->set_name("Extra");
  EXPECT_EQ(breaking_changes(present(), after), std::vector<std::string>{});
}

}  // namespace
}  // namespace planemap
