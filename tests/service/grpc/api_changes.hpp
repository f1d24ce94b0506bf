#pragma once

#include <google/protobuf/descriptor.pb.h>

#include <string>
#include <vector>

namespace planemap {

/// What in an interface would break clients that were made for an earlier one: a message, field, value, service or call
/// that has gone or has another number, name, type or kind. One line for each; what is new breaks nothing.
std::vector<std::string> breaking_changes(const google::protobuf::FileDescriptorSet& before,
                                          const google::protobuf::FileDescriptorSet& after);

}  // namespace planemap
