/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Tactus in C: scenes, and what receives packets and plays streams; tactus_encoder.h has what makes them, tactus_session.h sessions. The
 * functions wrap those of the C++ library: <tactus/tactus.h> and the specification tell more about what they do. SI units, right-handed
 * world frame, quaternions w x y z, time in integer ticks of the scene.
 *
 * Errors    Functions that can fail return TACTUS_OK, TACTUS_NOTHING (no error: none is there) or the class of an error. The last
 *           argument takes the error, with the rule of the specification that was broken and its texts; it may be NULL, and is written when
 *           there is an error. After an error outputs and objects are unchanged unless the function's comment says otherwise.
 *           NULL and indices that name nothing give TACTUS_INVALID_ARGUMENT R-API-12.
 * Objects   are made by _create, _open, _parse or _build, and destroyed by _destroy, which takes NULL. What a function returns as
 *           `const` or calls borrowed belongs to the object that it came from.
 * Options   are structs with their size, filled with the defaults by tactus_init; NULL stands for all of the defaults. Structs for
 *           answers need their size alone: tactus_packet_info info = {.size = sizeof info}.
 * Versions  Structs with a size grow at their end in later versions; the others never change. So a program may be older or newer than the
 *           library. Where its struct is
 *             shorter   options beyond its end have their defaults, and answers end where it ends;
 *             longer    options that the library does not know must be 0, and answers that it does not know become 0.
 *           A size that no version had, or above 4096, and an option that the library does not know give TACTUS_INVALID_ARGUMENT R-API-12.
 * Buffers   belong to the caller. Bytes that a function reads are not needed after it returns, except those of tactus_player_open.
 *           Where a buffer is too small the function returns TACTUS_BUFFER_TOO_SMALL R-API-13 and nothing is lost.
 * Threads   A scene never changes and may be shared. Any other object is used by one thread at a time.
 * Memory    Senders, receivers and players allocate when they are made, and not in each tick.
 */
#ifndef TACTUS_H
#define TACTUS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(_WIN32) && !defined(TACTUS_STATIC)
#define TACTUS_API __declspec(dllimport)
#elif defined(__GNUC__)
#define TACTUS_API __attribute__((visibility("default")))
#else
#define TACTUS_API
#endif

#define TACTUS_VERSION 0x000100 /* of this header: major, minor, patch, a byte each */

/* ---------------------------------------------------------------- errors */

typedef int32_t tactus_status;
enum {
  TACTUS_OK = 0,
  TACTUS_TRUNCATED = 2,      /* the input ends inside an element. 2 to 12: error classes of the specification, spec/registry.md */
  TACTUS_MALFORMED = 3,      /* syntax */
  TACTUS_INVALID = 4,        /* semantics: a value outside its declared range */
  TACTUS_UNSUPPORTED = 5,    /* a version, profile or option that this build does not know */
  TACTUS_LIMIT_EXCEEDED = 6, /* valid, but larger than the limits, or than the memory */
  TACTUS_CHECKSUM = 7,       /* a check value does not match */
  TACTUS_STATE = 8,          /* protocol order: baseline not held, packet stale */
  TACTUS_INVALID_ARGUMENT = 10, /* an argument of the call */
  TACTUS_IO = 11,               /* the operating system refused to read or write */
  TACTUS_INTERNAL = 12,         /* a defect of this library */
  TACTUS_NOTHING = 64,          /* no error: no packet is due, no datagram waits, nothing was declared */
  TACTUS_BUFFER_TOO_SMALL = 65
};

/* Texts are static but the last two, which live until the next call of the object that failed, or of this thread where there is none. */
typedef struct tactus_error {
  tactus_status status;
  int32_t advice;      /* to a receiver: TACTUS_ADVICE_... */
  uint64_t bit_offset; /* position in the input, in bits; 0 when there is none */
  const char* name;    /* of the class: "malformed" */
  const char* rule;    /* in spec/rules.csv, such as "R-STR-4" */
  const char* text;    /* "the check value of a record does not match" */
  const char* remedy;  /* a sentence on how to fix it, may be empty */
  const char* object;  /* of a scene, that it concerns; may be empty */
  const char* detail;  /* figures of this case, or all that a recording has to say: file, row, value, remedy; may be empty */
} tactus_error;

/* How a receiver reacts to what it cannot decode. */
enum {
  TACTUS_ADVICE_NONE = 0,
  TACTUS_ADVICE_DROP = 1,        /* ignore the packet */
  TACTUS_ADVICE_REQUEST_KEY = 2, /* ask the sender for a key packet */
  TACTUS_ADVICE_CLOSE = 3        /* neither the scene nor the packets after it can be used */
};

TACTUS_API uint32_t tactus_version(void); /* of the library, as TACTUS_VERSION */
/* The error of one who breaks a rule, such as that of tactus_held, with its texts.   in  rule  lives as long as the error; NULL: ""
   out  error  name and texts are "unknown" or empty where there are none   err  R-API-12 NULL */
TACTUS_API tactus_status tactus_describe(tactus_status status, const char* rule, tactus_error* error);

/* ---------------------------------------------------------------- options */

/* Structs of tactus.h, tactus_encoder.h and tactus_session.h that have defaults. */
enum {
  TACTUS_RIGID_BOUNDS = 1,
  TACTUS_DEFORMABLE_BOUNDS = 2,
  TACTUS_LOAD_BOUNDS = 3,
  TACTUS_LIMITS = 4,
  TACTUS_RECEIVER_OPTIONS = 5,
  TACTUS_SCENE_OPTIONS = 6,
  TACTUS_RIGID_OPTIONS = 7,
  TACTUS_DEFORMABLE_OPTIONS = 8,
  TACTUS_DRIVEN_PHYSICS = 9,
  TACTUS_ELASTIC_PHYSICS = 10,
  TACTUS_SENDER_OPTIONS = 11,
  TACTUS_TRUTH = 12,
  TACTUS_SERVER_OPTIONS = 13,
  TACTUS_CLIENT_OPTIONS = 14
};
/* Fill a struct with its defaults.   in  kind  TACTUS_RIGID_BOUNDS of a tactus_rigid_bounds, and so on;  size  its sizeof */
TACTUS_API tactus_status tactus_init(int32_t kind, void* options, size_t size);

/* ---------------------------------------------------------------- values */

typedef struct tactus_pose {
  double position[3]; /* m, world */
  double rotation[4]; /* unit quaternion w x y z, object to world */
} tactus_pose;

typedef struct tactus_device_sample {
  double position[3];    /* m, world */
  double orientation[4]; /* of the handle, unit quaternion w x y z */
  double velocity[3];    /* m/s, world; 0 if the device does not measure it */
  uint32_t buttons;      /* bit i: button i is down */
  uint32_t reserved;
  int64_t time; /* ns on the device's clock, not negative */
} tactus_device_sample;

/* Degrees of freedom of a rigid object: bits. Rotation is about none, one or all axes. None at all: static, never sent. */
enum {
  TACTUS_DOF_X = 1,
  TACTUS_DOF_Y = 2,
  TACTUS_DOF_Z = 4,
  TACTUS_DOF_RX = 8,
  TACTUS_DOF_RY = 16,
  TACTUS_DOF_RZ = 32,
  TACTUS_DOF_NONE = 0,
  TACTUS_DOF_ALL = 63
};

/* When the force error of a rigid object is too large. */
enum {
  TACTUS_HAPTIC_OFF = 0,
  TACTUS_HAPTIC_ISOTROPIC = 1, /* |f^ - f| > p |f| */
  TACTUS_HAPTIC_CONE = 2,      /* ||f^| - |f|| > p |f|, or an angle over cone_angle */
  TACTUS_HAPTIC_FIXED = 3,     /* position or rotation over fixed_..., in contact */
  TACTUS_HAPTIC_PERCEPTUAL = 4 /* isotropic, with the fraction that people notice at this force */
};

typedef struct tactus_rigid_bounds {
  uint32_t size;
  int32_t haptic;             /* TACTUS_HAPTIC_...; isotropic */
  double heartbeat;           /* s; 1; 0: off */
  double visual_position;     /* m; 3e-4 */
  double visual_rotation;     /* rad; 2 deg */
  double weber_fraction;      /* p; 0.04 */
  double perceptual_fraction; /* 1 */
  double cone_angle;          /* rad; 2.1 deg */
  double fixed_position;      /* m; 0.0015 */
  double fixed_rotation;      /* rad; 2 deg */
  double force_floor;         /* N; 0.05: below it the bound is that at this force */
} tactus_rigid_bounds;

typedef struct tactus_deformable_bounds {
  uint32_t size;
  int32_t haptic;        /* 1; 0: no haptic threshold */
  double visual;         /* m; 3e-4: v of every vertex */
  double weber_fraction; /* 0.04: p of h = p f / k_c around a touch */
  double depth_floor;    /* m; 2e-4: lower limit of f / k_c */
  int32_t kept;          /* answers only: 0: the stream aims at its bounds (profile thesis) */
  int32_t reserved;
} tactus_deformable_bounds;

typedef struct tactus_load_bounds {
  uint32_t size;
  uint32_t reserved;
  double weber_fraction; /* 0.1 */
  double force_floor;    /* N; 0.5 */
} tactus_load_bounds;

/* What a decoder accepts, checked before it allocates. */
typedef struct tactus_limits {
  uint32_t size;
  uint32_t objects;      /* 4096 */
  uint32_t header_bytes; /* 2^26 */
  uint32_t packet_bytes; /* 2^26 */
  uint32_t vertices;     /* 2^20, of all deformable objects */
  uint32_t triangles;    /* 2^21 */
  uint64_t state_bytes;  /* 2^28, of all states that are kept */
  uint64_t basis_work;   /* 2^22, units of about 0.3 us */
} tactus_limits;

enum { TACTUS_PROFILE_THESIS = 0, TACTUS_PROFILE_MAIN = 1 };
enum { TACTUS_KIND_RIGID = 0, TACTUS_KIND_DEFORMABLE = 1, TACTUS_KIND_LOAD = 2 };
enum { TACTUS_LAYER_HAPTIC = 0, TACTUS_LAYER_VISUAL = 1, TACTUS_LAYER_ALL = 2 };
enum { TACTUS_REASON_REQUEST = 0, TACTUS_REASON_HEARTBEAT = 1, TACTUS_REASON_VISUAL = 2, TACTUS_REASON_HAPTIC = 3 };

/* A packet, as it was sent or decoded. */
typedef struct tactus_packet_info {
  uint32_t size;
  uint32_t bytes; /* of the packet */
  int64_t tick;
  uint64_t number;    /* as the transport tells it: above 0, below 2^62; of a file: counted, or as the record says */
  uint64_t offset;    /* in the file; 0 elsewhere */
  uint32_t substream; /* 0: rigid objects; i + 1: deformable object i; the next: loads */
  uint32_t kind;      /* TACTUS_KIND_... */
  uint32_t key;       /* 1: builds on the initial state */
  uint32_t layer;     /* TACTUS_LAYER_..., deformable objects */
  uint32_t reason;    /* TACTUS_REASON_..., rigid objects: strongest among the updates */
  uint32_t updates;   /* objects named, or vertices with a residual of their own */
} tactus_packet_info;

enum { TACTUS_OUT_OF_INTEREST = 7 }; /* level of detail of an object that is not sent to a client */

/* ---------------------------------------------------------------- scene */

typedef struct tactus_scene tactus_scene; /* immutable */

typedef struct tactus_scene_info {
  uint32_t size;
  uint32_t tick_rate; /* per second */
  uint32_t rigid, deformables, substreams;
  uint32_t position_exp;  /* positions are multiples of 2^-position_exp m */
  uint32_t extrapolation; /* ticks after which an object without updates stops */
  uint32_t baselines;
  uint32_t smoothed; /* 1: rigid objects are of profile main */
  uint32_t has_bounds;
  uint32_t has_loads, load_users;
  double interest_full, interest_reach; /* m: within these rigid objects are sent to a client; 0: all are */
} tactus_scene_info;

typedef struct tactus_rigid_info {
  uint32_t size;
  uint32_t dof;     /* TACTUS_DOF_... */
  const char* name; /* UTF-8; lives as long as the scene */
  tactus_pose initial;
} tactus_rigid_info;

typedef struct tactus_deformable_info {
  uint32_t size;
  uint32_t vertices, triangles;
  uint32_t profile; /* TACTUS_PROFILE_... */
  uint32_t layered;
  uint32_t modes;      /* of its basis; 0: none */
  double frame_period; /* ticks from shape to shape */
  const char* name;    /* UTF-8; lives as long as the scene */
  uint32_t rings;      /* size of the area of interest around a touched triangle */
  uint32_t clusters;   /* of vertices that move alike, which make 12 modes each; 0: none */
  uint32_t blend;      /* rounds in which the clusters are blended where they meet */
  uint32_t has_stiffness;
} tactus_deformable_info;

/* The caller's room for the arrays of a deformable object; NULL: not wanted. */
typedef struct tactus_mesh_arrays {
  uint32_t size;
  uint32_t vertices, triangles; /* for so many there is room: at least those of tactus_deformable_info */
  uint32_t reserved;
  float* rest;       /* x y z of each vertex at rest, m, world */
  uint32_t* corners; /* 3 corners of each, counter-clockwise seen from outside */
  double* stiffness; /* of each vertex, N/m, infinite where it does not move */
  uint8_t* clusters; /* cluster of each vertex */
} tactus_mesh_arrays;

/* Parse a scene declaration from the front of `bytes`.   out  used  bytes that it took; may be NULL
   err  R-STR, R-DEF */
TACTUS_API tactus_status tactus_scene_parse(const uint8_t* bytes, size_t size, const tactus_limits* limits, tactus_scene** scene,
                                            size_t* used, tactus_error* error);
/* The declaration as bytes. Equal scenes give equal bytes.   out  size  needed or written */
TACTUS_API tactus_status tactus_scene_write(const tactus_scene* scene, uint8_t* bytes, size_t capacity, size_t* size,
                                            tactus_error* error);
TACTUS_API void tactus_scene_destroy(tactus_scene* scene); /* senders and receivers of it live on */
TACTUS_API tactus_status tactus_scene_get(const tactus_scene* scene, tactus_scene_info* info, tactus_error* error);
TACTUS_API tactus_status tactus_scene_get_rigid(const tactus_scene* scene, uint32_t object, tactus_rigid_info* info,
                                                tactus_error* error);
TACTUS_API tactus_status tactus_scene_get_deformable(const tactus_scene* scene, uint32_t object, tactus_deformable_info* info,
                                                     tactus_error* error);
/* Fill the arrays that are wanted.   err  TACTUS_NOTHING: it has no stiffness, or no clusters, that were wanted; nothing is written */
TACTUS_API tactus_status tactus_scene_get_mesh(const tactus_scene* scene, uint32_t object, const tactus_mesh_arrays* arrays,
                                               tactus_error* error);
/* Bounds that the sender guarantees; NULL: not wanted. TACTUS_NOTHING: one that is wanted is not declared, and nothing is written.
   in   object  whose bounds `deformable` takes; else it does not count */
TACTUS_API tactus_status tactus_scene_get_bounds(const tactus_scene* scene, tactus_rigid_bounds* rigid, uint32_t object,
                                                 tactus_deformable_bounds* deformable, tactus_load_bounds* load,
                                                 tactus_error* error);

/* ---------------------------------------------------------------- receiver: packets in, replica out */

typedef struct tactus_receiver tactus_receiver;

enum {
  TACTUS_INTERPOLATION_NONE = 0,
  TACTUS_INTERPOLATION_LINEAR = 1,
  TACTUS_INTERPOLATION_HERMITE = 2,
  TACTUS_INTERPOLATION_BLENDING = 3,
  TACTUS_INTERPOLATION_PLAYOUT = 4 /* the client shows the past and interpolates over the gaps that losses leave */
};

typedef struct tactus_receiver_options {
  uint32_t size;
  int32_t interpolation;       /* TACTUS_INTERPOLATION_...; none */
  double fraction;             /* 0.75 of the mean of the last 5 inter-arrival times */
  double shortest;             /* s; 0.005 */
  double longest;              /* s; 0.1 */
  const tactus_limits* limits; /* NULL: defaults */
} tactus_receiver_options;

/* One object of the packet decoded last. */
typedef struct tactus_update {
  uint32_t object;
  uint32_t reason; /* TACTUS_REASON_... */
  uint32_t level;  /* grid level */
} tactus_update;

#define TACTUS_PACKET_TICK INT64_MIN /* the replica applies a packet at the packet's own tick */

TACTUS_API tactus_status tactus_receiver_create(const tactus_scene* scene, const tactus_receiver_options* options,
                                                tactus_receiver** receiver, tactus_error* error);
TACTUS_API void tactus_receiver_destroy(tactus_receiver* receiver); /* does nothing to a borrowed one */
TACTUS_API const tactus_scene* tactus_receiver_scene(const tactus_receiver* receiver);
/* Decode a packet. Its number is not in its bytes: send both. A sender that restarts counts anew, so its packets go to a new receiver.
   in   number  of the packet, as its sender gave it: above 0, below 2^62
        packet  NULL with size 0: the number came, and no packet of rigid objects has it, so that a client with
                TACTUS_INTERPOLATION_PLAYOUT need not interpolate over it; info is not written
        now     the client's tick at which the replica applies it, or TACTUS_PACKET_TICK;  info  may be NULL
   err  R-API-5 no such number; its advice says how to react: R-PKT, R-RIG, R-DEF, R-RNG */
TACTUS_API tactus_status tactus_receiver_push(tactus_receiver* receiver, uint64_t number, const uint8_t* packet, size_t size,
                                              int64_t now, tactus_packet_info* info, tactus_error* error);
/* Objects that the packet decoded last named.   out  count  needed or written */
TACTUS_API tactus_status tactus_receiver_updates(const tactus_receiver* receiver, tactus_update* out, size_t capacity,
                                                 size_t* count, tactus_error* error);
/* Poses as shown at a tick, of rigid objects `first` to `first + count - 1`.   time about 50 ns each
   in   poses, levels  NULL: not wanted
   out  levels  of detail, in a scene with interest: the bounds of an object are 2^level times as wide; TACTUS_OUT_OF_INTEREST: do not
                show it. In any other scene 0 */
TACTUS_API tactus_status tactus_receiver_poses(const tactus_receiver* receiver, int64_t tick, uint32_t first, size_t count,
                                               tactus_pose* poses, uint8_t* levels, tactus_error* error);
/* Displacements from rest as shown at a tick, x y z of vertex 0 first, m.   in  capacity  [floats] at least 3 vertices */
TACTUS_API tactus_status tactus_receiver_displacements(tactus_receiver* receiver, uint32_t object, int64_t tick, float* out,
                                                       size_t capacity, tactus_error* error);
/* Forces on a rigid object, N, world: external, hold, then one per user. TACTUS_NOTHING: the scene sends none of it.
   in  capacity  [doubles] at least 3 (2 + load_users) */
TACTUS_API tactus_status tactus_receiver_loads(const tactus_receiver* receiver, uint32_t object, int64_t tick, double* out,
                                               size_t capacity, tactus_error* error);
/* Hashes that are equal at every end.   out  state  of the newest state of a substream;  poses  of every pose as shown at a tick; NULL: not
   wanted, and its argument does not count */
TACTUS_API tactus_status tactus_receiver_hash(const tactus_receiver* receiver, uint32_t substream, uint64_t* state, int64_t tick,
                                              uint64_t* poses, tactus_error* error);

/* ---------------------------------------------------------------- player: a stream file, tick by tick */

typedef struct tactus_player tactus_player;

typedef struct tactus_player_info {
  uint32_t size;
  uint32_t complete;     /* 1: the file has its end; valid after the last packet */
  int64_t next_tick;     /* of the next packet; INT64_MAX at the end */
  uint64_t header_bytes; /* of the scene declaration */
} tactus_player_info;

/* in   file  stays valid and unchanged until the player is destroyed
   err  R-STR, R-DEF, R-FIL */
TACTUS_API tactus_status tactus_player_open(const uint8_t* file, size_t size, const tactus_receiver_options* options,
                                            tactus_player** player, tactus_error* error);
TACTUS_API void tactus_player_destroy(tactus_player* player);
TACTUS_API tactus_receiver* tactus_player_receiver(tactus_player* player); /* borrowed */
/* Apply the next packet that is due at `tick`; TACTUS_NOTHING when none is. Call it until then.   in  info  may be NULL
   err  R-FIL and those of tactus_receiver_push, with positions in the file */
TACTUS_API tactus_status tactus_player_play(tactus_player* player, int64_t tick, tactus_packet_info* info, tactus_error* error);
/* err  as tactus_player_play, of the next packet */
TACTUS_API tactus_status tactus_player_get(tactus_player* player, tactus_player_info* info, tactus_error* error);

#ifdef __cplusplus
}
#endif

#endif
