#pragma once

#include <cstdint>
#include <initializer_list>
#include <planemap/config.hpp>
#include <planemap/expected.hpp>
#include <string>
#include <vector>

#include "config/input_config.hpp"

namespace planemap::service {

// Settings of the service, one struct a module; each lists its settings in visit_fields(), as those of core do. The
// limits in a FieldInfo are those of the value for numbers and those of the length for words and lists; for a list of
// words there is visit(info, value, choices).

/// Names and directions of the map.
struct MapConfig {
  std::string frame = "world";
  std::vector<double> gravity;  ///< unit vector, points down in the world frame; empty: not known
};

template <MaybeConst<MapConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"frame", "name of the world frame, told to clients", 1, 255}, c.frame);
  visit(FieldInfo{"gravity", "points down in the world frame, x y z; [] where it is not known (no plane classes then)",
                  0, 3},
        c.gravity);
}

struct LcmConfig {
  std::string url;               ///< empty: the environment's LCM_DEFAULT_URL, else kDefaultLcmUrl
  int recv_buf_bytes = 2097152;  ///< added to udpm URLs as recv_buf_size
};

/// LCM's usual group, not leaving the machine.
constexpr const char* kDefaultLcmUrl = "udpm://239.255.76.67:7667?ttl=0";

template <MaybeConst<LcmConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"url", "empty: LCM_DEFAULT_URL of the environment, else udpm://239.255.76.67:7667?ttl=0", 0, 1024},
        c.url);
  visit(FieldInfo{"recv_buf_bytes", "receive buffer that is asked of the kernel; net.core.rmem_max limits it", 65536,
                  1e9},
        c.recv_buf_bytes);
}

/// How poses are found for scans.
struct PoseConfig {
  double buffer_s = 10.0;   ///< history that is kept
  double restart_s = 1.0;   ///< a step back in time by more is a restart of the clock; messages are not late by so much
  double max_gap_s = 0.5;   ///< poses farther apart are not interpolated between
  double max_wait_s = 0.5;  ///< a scan waits so long for the pose after it
  double exact_s = 0.001;   ///< a pose this near to the scan's utime needs no other
  double jump_m = 1.0;      ///< a step between two poses above this is a jump: counted and said
  double jump_deg = 45.0;
  std::string jump = "continue";  ///< what a jump does to the map: nothing, or "reset"
  PoseErrorConfig error;          ///< load_config hands it to the mapper

  bool resets_map() const { return jump == "reset"; }
};

template <MaybeConst<PoseConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  using Words = std::initializer_list<const char*>;
  visit(FieldInfo{"buffer_s", "history of poses that is kept", 0.1, 600.0}, c.buffer_s);
  visit(FieldInfo{"restart_s", "a step back in time by more is a restart of the clock, by less a late arrival", 0.01,
                  600.0},
        c.restart_s);
  visit(FieldInfo{"max_gap_s", "poses farther apart than this are not interpolated between", 0.001, 60.0}, c.max_gap_s);
  visit(FieldInfo{"max_wait_s", "a scan waits this long for the pose after it", 0.0, 60.0}, c.max_wait_s);
  visit(FieldInfo{"exact_s", "a pose this near to a scan is its pose", 0.0, 1.0}, c.exact_s);
  visit(FieldInfo{"jump_m", "a longer step between two poses is a jump: counted and logged", 0.0, 1e6}, c.jump_m);
  visit(FieldInfo{"jump_deg", "a greater turn between two poses is a jump: counted and logged", 0.0, 180.0},
        c.jump_deg);
  visit(FieldInfo{"jump", "after a jump the same map goes on, or a new one begins, of a new epoch"}, c.jump,
        Words{"continue", "reset"});
  visit_fields(c.error, visit);
}

struct QueueConfig {
  int scans = 16;  ///< bound, half a second of a Kinect; the oldest is dropped
};

template <MaybeConst<QueueConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"scans", "scans that wait for the mapper; beyond, the oldest is dropped and counted", 1, 1000},
        c.scans);
}

struct MappingConfig {
  int threads = 1;  ///< that work on one scan; the map is the same
};

template <MaybeConst<MappingConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"threads", "that work on one scan; the map is the same", 1, 2}, c.threads);
}

struct PublishConfig {
  std::string status_channel = "PLANEMAP_STATUS";
  std::string delta_channel = "PLANEMAP_DELTA";
  std::string request_channel = "PLANEMAP_REQUEST";
  std::string point_cloud_channel;    ///< empty: no clouds of planes go out
  double point_cloud_period_s = 1.0;  ///< least time between two of them
  int point_cloud_points = 4000;      ///< of one at most
  double status_period_s = 1.0;
  double delta_period_s = 0.02;  ///< least time between two deltas: at 30 Hz each scan has its own
  int page_bytes = 60000;
  double page_pause_s = 0.0005;  ///< between two pages, so that receivers keep up
  int kept_replies = 8;          ///< replies kept for lost pages
};

template <MaybeConst<PublishConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"status_channel", "planemap_lcm.status_t goes out here", 1, kMaxChannelChars}, c.status_channel);
  visit(FieldInfo{"delta_channel", "planemap_lcm.planes_t goes out here", 1, kMaxChannelChars}, c.delta_channel);
  visit(FieldInfo{"request_channel", "planemap_lcm.request_t comes in here", 1, kMaxChannelChars}, c.request_channel);
  visit(
      FieldInfo{"point_cloud_channel",
                "planes as drake.lcmt_point_cloud for Drake's viewer, usually DRAKE_POINT_CLOUD_PLANEMAP; empty: none",
                0, kMaxChannelChars},
      c.point_cloud_channel);
  visit(FieldInfo{"point_cloud_period_s", "least time between two such clouds", 0.1, 60.0}, c.point_cloud_period_s);
  visit(FieldInfo{"point_cloud_points", "points of such a cloud at most, 16 bytes each in one message", 100, 1000000},
        c.point_cloud_points);
  visit(FieldInfo{"status_period_s", "time between two status messages", 0.05, 60.0}, c.status_period_s);
  visit(FieldInfo{"delta_period_s", "least time between two deltas", 0.01, 60.0}, c.delta_period_s);
  visit(FieldInfo{"page_bytes", "greatest message that is sent", 4096, 60000}, c.page_bytes);
  visit(FieldInfo{"page_pause_s", "between two pages, so that receivers keep up", 0.0, 1.0}, c.page_pause_s);
  visit(FieldInfo{"kept_replies", "replies that are kept, so that lost pages can be asked for again", 1, 1000},
        c.kept_replies);
}

struct GrpcConfig {
  std::string listen = "127.0.0.1:7670";  ///< HOST:PORT, [HOST]:PORT for IPv6; port 0: any free one; empty: no server
  std::string tls_certificate;            ///< PEM file, the server's own first, then those that signed it
  std::string tls_key;                    ///< PEM file
  std::string tls_client_ca;              ///< PEM file; empty: clients need no certificate
  std::string token_file;                 ///< empty: no tokens are asked for
  int threads = 2;                        ///< that work out answers
  int max_waiting_calls = 64;             ///< for one of the threads; more are refused
  int max_connections = 64;
  int max_streams_per_connection = 64;  ///< calls at a time on one connection; more wait in the client
  int max_streams = 128;                ///< watchers and answers in pages, of all clients; more are refused
  int max_request_bytes = 1048576;
  double index_age_s = 0.25;    ///< a query is answered by a map that may be older by so much
  double watch_period_s = 0.1;  ///< least time between two deltas
  double heartbeat_s = 5.0;     ///< of watchers that ask for no other
};

template <MaybeConst<GrpcConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(
      FieldInfo{"listen", "HOST:PORT, off the loopback with TLS only; port 0: any free one; empty: no server", 0, 255},
      c.listen);
  visit(FieldInfo{"tls_certificate", "PEM file: the server's certificate, then those that signed it; empty: no TLS", 0,
                  4096},
        c.tls_certificate);
  visit(FieldInfo{"tls_key", "PEM file: the certificate's private key", 0, 4096}, c.tls_key);
  visit(FieldInfo{"tls_client_ca",
                  "PEM file: clients need a certificate that one of these signed; empty: they need none", 0, 4096},
        c.tls_client_ca);
  visit(FieldInfo{"token_file", "lines of a scope (read or admin) and a token; empty: no token is asked for", 0, 4096},
        c.token_file);
  visit(FieldInfo{"threads", "threads that work out answers", 1, 64}, c.threads);
  visit(FieldInfo{"max_waiting_calls", "calls that wait for one of the threads; more are refused", 1, 10000},
        c.max_waiting_calls);
  visit(FieldInfo{"max_connections", "connections at a time; more are closed at once", 1, 10000}, c.max_connections);
  visit(FieldInfo{"max_streams_per_connection", "calls at a time on one connection; more wait in the client", 1, 10000},
        c.max_streams_per_connection);
  visit(FieldInfo{"max_streams", "watchers and answers in pages at a time, of all clients; more are refused", 1, 10000},
        c.max_streams);
  visit(FieldInfo{"max_request_bytes", "greatest message that is taken", 1024, 4194304}, c.max_request_bytes);
  visit(FieldInfo{"index_age_s", "queries may be answered by a map that is older by so much; 0: always the newest", 0.0,
                  60.0},
        c.index_age_s);
  visit(FieldInfo{"watch_period_s", "least time between two deltas of Watch", 0.01, 60.0}, c.watch_period_s);
  visit(FieldInfo{"heartbeat_s", "watchers hear something at least so often, unless they ask for another time", 0.1,
                  3600.0},
        c.heartbeat_s);
}

struct HttpConfig {
  std::string listen = "127.0.0.1:7671";  ///< HOST:PORT, [HOST]:PORT for IPv6; port 0: any free one; empty: no server
  bool allow_remote = false;              ///< listens off the loopback, too: plain text, without authentication
  int threads = 2;                        ///< that work out answers
  int max_waiting_requests = 64;          ///< for one of the threads; more are refused
  int max_connections = 64;               ///< beyond, the one that is idle for longest is closed
  int max_event_streams = 32;             ///< of the connections; more are refused
  double update_period_s = 0.1;           ///< least time between two deltas; answers may be older by so much
  double heartbeat_s = 5.0;               ///< event streams hear something at least so often
};

template <MaybeConst<HttpConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"listen", "HOST:PORT; port 0: any free one; empty: no server", 0, 255}, c.listen);
  visit(FieldInfo{"allow_remote", "listen may be off the loopback: anybody there reads all, in plain text"},
        c.allow_remote);
  visit(FieldInfo{"threads", "threads that work out answers", 1, 64}, c.threads);
  visit(FieldInfo{"max_waiting_requests", "requests that wait for one of the threads; more are refused", 1, 10000},
        c.max_waiting_requests);
  visit(FieldInfo{"max_connections", "connections at a time; beyond, the one that is idle for longest is closed", 2,
                  10000},
        c.max_connections);
  visit(
      FieldInfo{"max_event_streams", "of the connections, those that are told of changes; more are refused", 1, 10000},
      c.max_event_streams);
  visit(FieldInfo{"update_period_s", "least time between two deltas; answers may be older by so much", 0.01, 60.0},
        c.update_period_s);
  visit(FieldInfo{"heartbeat_s", "event streams hear something at least so often", 0.1, 60.0}, c.heartbeat_s);
}

struct LogConfig {
  std::string level = "info";
  std::string format = "text";
};

template <MaybeConst<LogConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  using Words = std::initializer_list<const char*>;
  visit(FieldInfo{"level", "least important message that is logged"}, c.level,
        Words{"trace", "debug", "info", "warn", "error"});
  visit(FieldInfo{"format", "text for people, json for machines: one object a line"}, c.format, Words{"text", "json"});
}

struct LimitsConfig {
  int image_bytes = 67108864;     ///< greatest scan after decompression
  int waiting_bytes = 268435456;  ///< all scans that wait for a pose
};

template <MaybeConst<LimitsConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"image_bytes", "greatest scan after decompression; greater ones are rejected", 1024, 1e9},
        c.image_bytes);
  visit(FieldInfo{"waiting_bytes", "memory of scans that wait for a pose; beyond, the oldest is dropped", 1024, 2e9},
        c.waiting_bytes);
}

struct StoreConfig {
  std::string path;         ///< of the map file; empty: the map ends with the process
  double interval_s = 1.0;  ///< between two commits: what a crash can lose
  double backup_s = 600.0;  ///< between two backups
};

template <MaybeConst<StoreConfig> Config, class Visit>
void visit_fields(Config& c, Visit&& visit) {
  visit(FieldInfo{"path", "map file, made where there is none; empty: the map ends with the process", 0, 4096}, c.path);
  visit(FieldInfo{"interval_s", "what changed is written so often: what a crash can lose", 0.05, 60.0}, c.interval_s);
  visit(
      FieldInfo{"backup_s", "a copy is written beside the file (.backup) at the start and so often; 0: none", 0.0, 1e6},
      c.backup_s);
}

struct ServiceConfig {
  MapperConfig mapper;  ///< sections core, sensor, grid, normals, planes and wear
  MapConfig map;
  LcmConfig lcm;
  std::vector<InputConfig> inputs = {InputConfig{}};
  PoseConfig pose;
  QueueConfig queue;
  MappingConfig mapping;
  PublishConfig publish;
  GrpcConfig grpc;
  HttpConfig http;
  StoreConfig store;
  LogConfig log;
  LimitsConfig limits;
};

/// A section of the file.
struct SectionInfo {
  const char* key;
  const char* help;
};

/// Calls visit(SectionInfo, struct) for each section in the file's order; inputs is a list of structs.
template <MaybeConst<ServiceConfig> Config, class Visit>
void visit_sections(Config& c, Visit&& visit) {
  visit(SectionInfo{"core", "How it is computed."}, c.mapper.core);
  visit(SectionInfo{"sensor", "Errors and limits of a Kinect-like depth sensor."}, c.mapper.sensor);
  visit(SectionInfo{"grid", "The uncertain grid."}, c.mapper.grid);
  visit(SectionInfo{"normals", "Uncertain normals of cells."}, c.mapper.normals);
  visit(SectionInfo{"planes", "Local and global planes."}, c.mapper.planes);
  visit(SectionInfo{"wear", "How things that have gone leave the map."}, c.mapper.wear);
  visit(SectionInfo{"map", "Names and directions of the map."}, c.map);
  visit(SectionInfo{"lcm", "The bus."}, c.lcm);
  visit(SectionInfo{"inputs", "Sensors: a list; each has a channel of its own."}, c.inputs);
  visit(SectionInfo{"pose", "How poses are found for scans."}, c.pose);
  visit(SectionInfo{"queue", "Scans with a pose, on their way to the mapper."}, c.queue);
  visit(SectionInfo{"mapping", "The mapper."}, c.mapping);
  visit(SectionInfo{"publish", "What goes out over LCM."}, c.publish);
  visit(SectionInfo{"grpc", "What remote clients may ask over gRPC (planemap.v1)."}, c.grpc);
  visit(SectionInfo{"http", "The viewer's page and what it asks, metrics and health, over HTTP."}, c.http);
  visit(SectionInfo{"store", "The map file: what outlives the process."}, c.store);
  visit(SectionInfo{"log", "The log, on standard error."}, c.log);
  visit(SectionInfo{"limits", "What is taken from the outside at most."}, c.limits);
}

/// Where the settings come from; later ones win: preset, file, overrides.
struct ConfigSources {
  std::string preset = "best";         ///< best or paper; --preset
  std::string file;                    ///< YAML; empty: none; --config
  std::vector<std::string> overrides;  ///< "section.key=value", the value in YAML; --set
};

/// Reads, overrides and checks. The error lists every problem, one a line, with file, line and key.
Expected<ServiceConfig> load_config(const ConfigSources& sources);

/// The configuration as YAML with a comment for each key; load_config reads it back to the same.
std::string to_yaml(const ServiceConfig& config);

/// The URL that lcm::LCM is to be given: the configured one, else LCM_DEFAULT_URL, else kDefaultLcmUrl; for udpm with
/// recv_buf_size unless it names one.
std::string effective_lcm_url(const LcmConfig& config);

}  // namespace planemap::service
