/* Asks planemapd which surfaces are nearest to a point: nearest_example X Y Z, metres, world frame.
 *
 * All that it knows of planemap are the .lcm files, through lcm-gen -c. The answer fits on one page here (see "count"), so a
 * lost datagram is mended by asking again; how to ask for single lost pages is in docs/lcm.md. */
#include <inttypes.h>
#include <lcm/lcm.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "planemap_lcm_reply_t.h"
#include "planemap_lcm_request_t.h"

enum { TRIES = 5, WAIT_MS = 1000 };

typedef struct {
  int64_t request_id;
  int is_done;
  int exit_code;
} answer_t;

static void on_reply(const lcm_recv_buf_t* buffer, const char* channel, const planemap_lcm_reply_t* reply, void* user) {
  answer_t* answer = user;
  (void)buffer;
  (void)channel;
  if (reply->request_id != answer->request_id || answer->is_done) return; /* not ours, or it came twice */
  answer->is_done = 1;
  if (reply->status != PLANEMAP_LCM_REPLY_T_STATUS_OK) {
    fprintf(stderr, "planemapd refused: %s\n", reply->error);
    answer->exit_code = 1;
    return;
  }
  printf("map %" PRId64 ", revision %" PRId64 "\n", reply->epoch, reply->revision);
  for (int32_t i = 0; i < reply->n_near_planes; ++i) {
    const planemap_lcm_near_plane_t* near = &reply->near_planes[i];
    printf("plane %" PRId64 ": surface %.4f m away; signed distance %.4f m +- %.2f mm\n", near->plane_id,
           near->surface_distance_m, near->signed_distance_m, 1e3 * near->sigma_m);
  }
}

int main(int argc, char** argv) {
  if (argc != 4) {
    fprintf(stderr, "usage: %s X Y Z\n", argv[0]);
    return 2;
  }
  lcm_t* lcm = lcm_create(NULL); /* LCM_DEFAULT_URL */
  if (lcm == NULL) {
    fprintf(stderr, "LCM can't be opened: is there a route for multicast?\n");
    return 3;
  }
  char channel[64];
  snprintf(channel, sizeof channel, "PLANEMAP_REPLY_c_%ld", (long)getpid());
  answer_t answer = {1, 0, 0};
  planemap_lcm_reply_t_subscribe(lcm, channel, on_reply, &answer);

  planemap_lcm_query_point_t point;
  memset(&point, 0, sizeof point);
  for (int i = 0; i < 3; ++i) point.point_m[i] = strtod(argv[i + 1], NULL);
  point.sigma_m = 0.01;
  planemap_lcm_nearest_query_t query = {.count = 3, .n_points = 1, .points = &point};
  planemap_lcm_request_t request;
  memset(&request, 0, sizeof request); /* all zeros: the newest map, every plane */
  request.request_id = answer.request_id;
  request.reply_channel = channel;
  request.operation = PLANEMAP_LCM_REQUEST_T_OPERATION_NEAREST;
  request.page = -1;
  request.n_nearest = 1;
  request.nearest = &query;
  for (int i = 0; i < TRIES && !answer.is_done; ++i) { /* a request changes nothing: it may be sent again */
    planemap_lcm_request_t_publish(lcm, "PLANEMAP_REQUEST", &request);
    if (lcm_handle_timeout(lcm, WAIT_MS) < 0) break;
  }
  if (!answer.is_done) {
    fprintf(stderr, "no planemapd answered\n");
    answer.exit_code = 3;
  }
  lcm_destroy(lcm);
  return answer.exit_code;
}
