#include "serve/lcm/outbox.hpp"

#include <utility>

namespace planemap::service {

void Outbox::add(Reply reply) {
  jobs_.push_back(Job{std::move(reply), true});
}

void Outbox::add(const std::string& channel, Pages pages) {
  if (pages.empty()) return;
  const std::size_t count = pages.size();
  jobs_.push_back(Job{Reply{channel, 0, std::make_shared<const Pages>(std::move(pages)), 0, count, {}}, false});
}

Outbox::Message Outbox::take(double now_s, std::int64_t utime) {
  Job& job = jobs_.front();
  Message message{job.reply.channel, (*job.reply.pages)[job.reply.begin]};
  if (job.is_reply) restamp_reply(message.bytes, utime, job.reply.request_id);
  if (++job.reply.begin == job.reply.end) jobs_.pop_front();
  due_s_ = now_s + page_pause_s_;
  return message;
}

}  // namespace planemap::service
