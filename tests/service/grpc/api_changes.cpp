#include "api_changes.hpp"

#include <map>

namespace planemap {
namespace {

using google::protobuf::DescriptorProto;
using google::protobuf::EnumDescriptorProto;
using google::protobuf::FieldDescriptorProto;
using google::protobuf::FileDescriptorSet;
using google::protobuf::MethodDescriptorProto;
using google::protobuf::ServiceDescriptorProto;

/// All messages, enumerations and services of files by their full names.
struct Interface {
  std::map<std::string, const DescriptorProto*> messages;
  std::map<std::string, const EnumDescriptorProto*> enums;
  std::map<std::string, const ServiceDescriptorProto*> services;

  explicit Interface(const FileDescriptorSet& files) {
    for (const auto& file : files.file()) {
      for (const auto& message : file.message_type()) add(file.package(), message);
      for (const auto& e : file.enum_type()) enums[file.package() + "." + e.name()] = &e;
      for (const auto& service : file.service()) services[file.package() + "." + service.name()] = &service;
    }
  }

 private:
  void add(const std::string& scope, const DescriptorProto& message) {
    const std::string name = scope + "." + message.name();
    messages[name] = &message;
    for (const auto& nested : message.nested_type()) add(name, nested);
    for (const auto& e : message.enum_type()) enums[name + "." + e.name()] = &e;
  }
};

/// Everything of a field that its readers count on, in words.
std::string text_of(const DescriptorProto& message, const FieldDescriptorProto& field) {
  std::string text = field.name() + ": " + FieldDescriptorProto::Type_Name(field.type());
  if (field.label() == FieldDescriptorProto::LABEL_REPEATED) text += " repeated";
  if (field.proto3_optional()) text += " optional";
  if (!field.type_name().empty()) text += " " + field.type_name();
  if (field.has_oneof_index() && !field.proto3_optional()) {
    text += " in " + message.oneof_decl(field.oneof_index()).name();
  }
  return text;
}

std::string text_of(const MethodDescriptorProto& method) {
  return std::string(method.client_streaming() ? "stream " : "") + method.input_type() + " -> " +
         (method.server_streaming() ? "stream " : "") + method.output_type();
}

/// Compares two lists of things that have a key and a text.
void compare(const std::string& owner, const std::map<std::string, std::string>& before,
             const std::map<std::string, std::string>& after, std::vector<std::string>& changes) {
  for (const auto& [key, text] : before) {
    const auto found = after.find(key);
    if (found == after.end()) {
      changes.push_back(owner + ": " + key + " (" + text + ") has gone");
    } else if (found->second != text) {
      changes.push_back(owner + ": " + key + " was '" + text + "', is '" + found->second + "'");
    }
  }
}

std::map<std::string, std::string> parts_of(const DescriptorProto& message) {
  std::map<std::string, std::string> parts;
  for (const auto& field : message.field()) parts["field " + std::to_string(field.number())] = text_of(message, field);
  return parts;
}
std::map<std::string, std::string> parts_of(const EnumDescriptorProto& e) {
  std::map<std::string, std::string> parts;
  for (const auto& value : e.value()) parts["value " + std::to_string(value.number())] = value.name();
  return parts;
}
std::map<std::string, std::string> parts_of(const ServiceDescriptorProto& service) {
  std::map<std::string, std::string> parts;
  for (const auto& method : service.method()) parts["call " + method.name()] = text_of(method);
  return parts;
}

template <class Things>
void compare(const Things& before, const Things& after, std::vector<std::string>& changes) {
  for (const auto& [name, thing] : before) {
    const auto found = after.find(name);
    if (found == after.end()) {
      changes.push_back(name + ": has gone");
    } else {
      compare(name, parts_of(*thing), parts_of(*found->second), changes);
    }
  }
}

}  // namespace

std::vector<std::string> breaking_changes(const FileDescriptorSet& before, const FileDescriptorSet& after) {
  const Interface old(before);
  const Interface now(after);
  std::vector<std::string> changes;
  compare(old.messages, now.messages, changes);
  compare(old.enums, now.enums, changes);
  compare(old.services, now.services, changes);
  return changes;
}

}  // namespace planemap
