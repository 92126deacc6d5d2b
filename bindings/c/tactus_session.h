/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Sessions over datagrams in C. Both ends are functions of bytes and time, without sockets and clocks. The program calls one of
 * _handle_datagram, _handle_timeout, _submit and the like, and then
 *   _poll_datagram until TACTUS_NOTHING, and sends what it gets;  _poll_event until TACTUS_NOTHING;
 *   waits for a datagram, the next tick or _next_timeout, whichever comes first.
 * Times are microseconds of any clock that never steps back. Each end may have its own. Datagrams are not sealed: keep them on one
 * machine, or carry them in DTLS. See <tactus/session/session_server.h> and tactus.h, whose rules hold here too.
 */
#ifndef TACTUS_SESSION_H
#define TACTUS_SESSION_H

#include "tactus_encoder.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { TACTUS_DATAGRAM_BYTES = 1200 }; /* no datagram is longer */

enum { TACTUS_ROLE_OBSERVER = 0, TACTUS_ROLE_PARTICIPANT = 1 /* touches: sends the samples of a device */ };

#define TACTUS_EVERY_CLIENT UINT32_MAX

enum { TACTUS_ONLY_LOOKS_ON = 255 }; /* the seat of a participant that has none, as it may not */

enum { TACTUS_SESSION_CLOSED = 0, TACTUS_SESSION_JOINING = 1, TACTUS_SESSION_RECEIVING = 2, TACTUS_SESSION_LIVE = 3 };

/* Why a session ended or did not begin. */
enum {
  TACTUS_LEAVE_BYE = 0,
  TACTUS_LEAVE_VERSION = 1, /* the server does not speak this version */
  TACTUS_LEAVE_FULL = 2,    /* no room for another client */
  TACTUS_LEAVE_LIMITS = 3,  /* the scene is beyond the client's limits */
  TACTUS_LEAVE_SILENCE = 4, /* nothing was heard for too long */
  TACTUS_LEAVE_SCENE = 5,   /* the client refuses the declaration */
  TACTUS_LEAVE_PROTOCOL = 6 /* the other end breaks rules again and again */
};

enum {
  TACTUS_EVENT_WELCOMED = 0,      /* client: the declaration is on its way */
  TACTUS_EVENT_JOINED = 1,        /* server: a client joined and gets the declaration */
  TACTUS_EVENT_LIVE = 2,          /* the declaration is there; client: the receiver has a new scene */
  TACTUS_EVENT_CLOSED = 3,        /* over, for `reason` */
  TACTUS_EVENT_BOUNDS_SCALED = 4, /* server: the bounds of the client are multiplied by `bound_scale` from now on */
  TACTUS_EVENT_MOVED = 5,         /* server: a client has another address, its `peer` */
  TACTUS_EVENT_REFUSED = 6        /* server: a join was refused, for `reason`; `client` is nobody */
};

typedef struct tactus_event {
  uint32_t size;
  uint32_t kind;   /* TACTUS_EVENT_... */
  uint32_t client; /* server */
  uint32_t reason; /* TACTUS_LEAVE_... */
  double bound_scale;
} tactus_event;

/* How a session does: at the client, or of one client at the server. */
typedef struct tactus_session_status {
  uint32_t size;
  uint32_t state; /* TACTUS_SESSION_... */
  uint32_t client;
  uint32_t role;                                                   /* server: TACTUS_ROLE_... */
  uint64_t peer;                                                   /* server */
  uint64_t declaration_bytes, declaration_received;                /* client: of the scene */
  uint32_t has_round_trip, has_clock_offset;                       /* 1: the next ones are known */
  int64_t round_trip, round_trip_variation, round_trip_least;      /* us */
  int64_t clock_offset;                                            /* client: us, the server's clock less the client's */
  uint64_t server_start;                                           /* client: us, the server's clock at tick 0 */
  int64_t playout_delay;                                           /* client: us behind the fastest packet */
  double loss;                                                     /* fraction of the last 256 datagrams to the other end */
  double bound_scale, largest_bound_scale;                         /* server: factor of the bounds, now and at most */
  uint64_t bounds_scaled_time;                                     /* server: us in which it was above 1 */
  uint64_t datagrams_sent, bytes_sent, packets_sent, payload_sent; /* payload: bytes of packets */
  uint64_t datagrams_heard, bytes_heard, packets_heard, payload_heard;
  uint64_t packets_refused, packets_held, lost, ticks_held, wrong_states;
  uint32_t seat;         /* what a participant plays, from 1; 0: nothing; TACTUS_ONLY_LOOKS_ON */
  uint32_t wanted_seat;  /* server: 0: any */
  uint64_t token;        /* client: with which another one goes on with this session (tactus_client_options); 0: none yet */
  uint64_t world;        /* client: what the server simulates, as its program declares; 0: it does not */
  double force_fraction; /* client: fraction of a force that may be rendered, 0 to 1: without news none */
  uint32_t has_device;   /* server: 1: the next one is known */
  uint32_t reserved;
  tactus_device_sample device; /* server: of a participant */
} tactus_session_status;

/* What the device feels: force = stiffness (proxy - position of the device). */
typedef struct tactus_device_contact {
  double proxy[3];  /* m, world */
  double stiffness; /* N/m */
} tactus_device_contact;

/* ---------------------------------------------------------------- server */

typedef struct tactus_server tactus_server;

typedef struct tactus_server_options {
  uint32_t size;
  uint32_t clients; /* at a time; 8 */
  uint32_t headers; /* bytes around a datagram; 28: UDP and IPv4 */
  uint32_t reserved;
  uint64_t rate;                       /* bit/s to each client; 0: no limit */
  uint64_t silence;                    /* us of silence after which a client's session is closed; 120 s */
  double max_bound_scale;              /* factor by which bounds are scaled at most where the network is too slow, 1 to 64; 8 */
  const tactus_sender_options* sender; /* for every client; NULL: defaults */
  uint64_t world;                      /* what is simulated, for programs of clients to compare; 0: not declared */
} tactus_server_options;

/* in   entropy  64 bits from the system that nobody else can guess */
TACTUS_API tactus_status tactus_server_create(const tactus_scene* scene, const tactus_server_options* options, uint64_t entropy,
                                              uint64_t now, tactus_server** server, tactus_error* error);
TACTUS_API void tactus_server_destroy(tactus_server* server);
/* in   peer  the program's name for the address that sent it, not 0   err  the datagram is dropped: R-SES */
TACTUS_API tactus_status tactus_server_handle_datagram(tactus_server* server, uint64_t now, uint64_t peer,
                                                       const uint8_t* datagram, size_t size, tactus_error* error);
TACTUS_API tactus_status tactus_server_handle_timeout(tactus_server* server, uint64_t now, tactus_error* error);
/* Code a tick for every live client.   err  as tactus_sender_encode; all clients that can are served
   out  encoded  NULL: not wanted. Its packets are none, as datagrams carry them; held parts are those of the last _submit that found a live
                 client */
TACTUS_API tactus_status tactus_server_submit(tactus_server* server, uint64_t now, int64_t tick, const tactus_truth* truth,
                                              tactus_encoded* encoded, tactus_error* error);
/* Another scene; ticks begin anew. */
TACTUS_API tactus_status tactus_server_replace_scene(tactus_server* server, const tactus_scene* scene, uint64_t now,
                                                     tactus_error* error);
/* What a participant plays, from 1; 0: nothing; TACTUS_ONLY_LOOKS_ON. It is signalled. Who comes back with its token has the seat that it had. */
TACTUS_API tactus_status tactus_server_seat(tactus_server* server, uint32_t client, uint32_t seat, tactus_error* error);
/* in   client  or TACTUS_EVERY_CLIENT, who are told TACTUS_LEAVE_BYE;  reason  TACTUS_LEAVE_... */
TACTUS_API tactus_status tactus_server_close(tactus_server* server, uint32_t client, uint32_t reason, tactus_error* error);
/* in   capacity  at least TACTUS_DATAGRAM_BYTES */
TACTUS_API tactus_status tactus_server_poll_datagram(tactus_server* server, uint64_t now, uint64_t* peer, uint8_t* bytes,
                                                     size_t capacity, size_t* size, tactus_error* error);
TACTUS_API tactus_status tactus_server_poll_event(tactus_server* server, tactus_event* event, tactus_error* error);
/* When to call _handle_timeout; TACTUS_NOTHING: never. */
TACTUS_API tactus_status tactus_server_next_timeout(const tactus_server* server, uint64_t* time, tactus_error* error);
/* in   client  below options.clients */
TACTUS_API tactus_status tactus_server_status(tactus_server* server, uint32_t client, uint64_t now, tactus_session_status* status,
                                              tactus_error* error);

/* ---------------------------------------------------------------- client */

typedef struct tactus_client tactus_client;

typedef struct tactus_client_options {
  uint32_t size;
  int32_t role;                /* TACTUS_ROLE_...; observer */
  uint32_t senses_velocity;    /* the device has a velocity; 0 */
  uint32_t every_tick;         /* send every sample, as exact as the grid; 0 */
  double device_position;      /* m; 1e-4: largest error in free space */
  double device_rotation;      /* rad; 0.02 */
  double device_weber;         /* 0.04: in contact */
  int64_t playout;             /* us behind the fastest packet; -1: adaptive */
  uint64_t silence;            /* us of silence after which the session is closed; 120 s */
  const tactus_limits* limits; /* NULL: defaults */
  uint64_t token;              /* of a session that ended without the server's knowledge; 0: none */
  uint32_t seat;               /* that a participant wants, from 1; 0: any */
  uint32_t reserved;
} tactus_client_options;

TACTUS_API tactus_status tactus_client_create(const tactus_client_options* options, tactus_client** client, tactus_error* error);
TACTUS_API void tactus_client_destroy(tactus_client* client);
/* Join.   in  nonce  64 bits from the system */
TACTUS_API tactus_status tactus_client_open(tactus_client* client, uint64_t now, uint64_t nonce, tactus_error* error);
TACTUS_API tactus_status tactus_client_close(tactus_client* client, tactus_error* error);
/* err  the datagram is dropped: R-SES */
TACTUS_API tactus_status tactus_client_handle_datagram(tactus_client* client, uint64_t now, const uint8_t* datagram, size_t size,
                                                       tactus_error* error);
TACTUS_API tactus_status tactus_client_handle_timeout(tactus_client* client, uint64_t now, tactus_error* error);
/* The device now; at most one sample per tick counts.   in  contact  NULL: it touches nothing */
TACTUS_API tactus_status tactus_client_submit(tactus_client* client, uint64_t now, const tactus_device_sample* sample,
                                              const tactus_device_contact* contact, tactus_error* error);
/* In a scene with interest: where the user looks from, x y z [m, world], apart from the device; before _open, too, as an observer is declared
   of all until it has reported it. tactus_receiver_poses declares what comes of it. What is not finite, or beyond 8000 km, does not count. */
TACTUS_API tactus_status tactus_client_set_viewpoint(tactus_client* client, uint64_t now, const double* viewpoint,
                                                     tactus_error* error);
/* in   capacity  at least TACTUS_DATAGRAM_BYTES */
TACTUS_API tactus_status tactus_client_poll_datagram(tactus_client* client, uint64_t now, uint8_t* bytes, size_t capacity,
                                                     size_t* size, tactus_error* error);
TACTUS_API tactus_status tactus_client_poll_event(tactus_client* client, tactus_event* event, tactus_error* error);
TACTUS_API tactus_status tactus_client_next_timeout(const tactus_client* client, uint64_t* time, tactus_error* error);
/* Borrowed; of the newest scene, NULL before the first. Show the tick of tactus_client_shown_tick. */
TACTUS_API tactus_receiver* tactus_client_receiver(tactus_client* client);
/* TACTUS_NOTHING: none yet */
TACTUS_API tactus_status tactus_client_shown_tick(tactus_client* client, uint64_t now, int64_t* tick, tactus_error* error);
TACTUS_API tactus_status tactus_client_status(tactus_client* client, uint64_t now, tactus_session_status* status,
                                              tactus_error* error);

#ifdef __cplusplus
}
#endif

#endif
