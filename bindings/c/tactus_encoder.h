/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Tactus in C: what declares a scene, turns its true states into packets, and writes them into a stream file. What is not asked for is coded
 * as by `tactus encode`. See tactus.h, whose rules hold here too, <tactus/scene/scene_builder.h> and <tactus/sender.h>.
 */
#ifndef TACTUS_ENCODER_H
#define TACTUS_ENCODER_H

#include "tactus.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---------------------------------------------------------------- scene builder */

typedef struct tactus_scene_builder tactus_scene_builder;

typedef struct tactus_scene_options {
  uint32_t size;
  uint32_t tick_rate;                                                      /* per second; 1000 */
  uint32_t position_exp, velocity_exp, rotation_exp, angular_velocity_exp; /* grids; 22 17 20 12 */
  uint32_t baselines;     /* states that a receiver keeps, 1 to 64; 1. A session wants 64 */
  uint32_t rigid_profile; /* TACTUS_PROFILE_...; main: look-ahead velocities, and clients smooth the errors of updates */
  uint32_t has_loads;     /* 1: send the forces on rigid objects; 0 */
  uint32_t load_users;    /* whose forces are sent; 1 */
  uint32_t force_exp;     /* forces are multiples of 2^-force_exp N; 10 */
  uint32_t reserved;
  double extrapolation; /* s after which an object without updates stops; 2 */
  double gravity[3];    /* m/s^2, world: updates may choose to fall; 0 */
  double friction;      /* ... or to slide to rest; 0 */
  /* m: rigid objects are sent to a client in full up to interest_full from where it looks, with bounds twice as wide at twice the distance,
     and of none beyond interest_reach; 0: of all in full */
  double interest_full, interest_reach;
  /* m: how far from the origin positions get, along any axis. The position grid becomes as fine as that permits, and none finer than
     position_exp; _build refuses a world too large for the declared bounds. 0: as position_exp is: 2^(31 - position_exp) m, 512 m */
  double world_size;
  const tactus_limits* limits; /* of all its receivers: for more than 4096 objects, say. NULL: defaults */
} tactus_scene_options;

/* A rigid object that a participant's device pushes or holds. */
typedef struct tactus_driven_physics {
  uint32_t size;
  uint32_t reserved;
  double mass;       /* kg */
  double inertia[3]; /* kg m^2, about the axes of the object's frame */
  double stiffness;  /* N/m, of the coupling between device and proxy */
  double hold;       /* N/m, of that to an object that it holds; 0: it holds none */
  double friction;   /* of the proxy on it; 0 */
  double damping;    /* 1/s: rate at which its velocities die away; 0 */
} tactus_driven_physics;

enum { TACTUS_METHOD_BACKWARD_EULER = 1, TACTUS_METHOD_TR_BDF2 = 2, TACTUS_METHOD_VELOCITY_VERLET = 3 };

typedef struct tactus_rigid_options {
  uint32_t size;
  uint32_t dof;        /* TACTUS_DOF_...; all */
  tactus_pose initial; /* at rest; the origin */
  /* In sessions, let a participant work out from its own device where the object goes. Packets tell what that gets wrong; NULL: do not.
     _build checks it: err  R-API-4 a constant cannot be told */
  const tactus_driven_physics* driven;
} tactus_rigid_options;

/* What a deformable object is made of, that a participant's device deforms. Vertices are those of the surface, then those inside. */
typedef struct tactus_elastic_physics {
  uint32_t size;
  uint32_t material_count; /* 1 to 255 */
  const double* materials; /* Young's modulus N/m^2, Poisson's ratio, density kg/m^3 of each */
  const double* inner;     /* x y z [m] of the vertices inside, at rest, world; NULL: there are none */
  size_t inner_count;      /* vertices */
  const uint32_t* tets;    /* 4 corners a b c d of each, (b - a) x (c - a) . (d - a) > 0 */
  size_t tet_count;        /* tetrahedra */
  const uint8_t* material; /* of each tetrahedron; NULL: the first */
  const uint32_t* fixed;   /* vertices that do not move, ascending; NULL: there are none */
  size_t fixed_count;
  double mass_damping;      /* 1/s; 0 */
  double stiffness_damping; /* s; 0 */
  double gravity[3];        /* m/s^2, world; 0 */
  double coupling;          /* N/m, between device and proxy */
  double friction;          /* of the proxy on the surface; 0 */
  uint32_t method;          /* TACTUS_METHOD_... of a step, that of the server if it has one; backward Euler */
  uint32_t sub_steps;       /* of velocity Verlet, 1 to 255, which is stable with them; 1 of the others */
} tactus_elastic_physics;

typedef struct tactus_deformable_options {
  uint32_t size;
  uint32_t profile;      /* TACTUS_PROFILE_...; main */
  uint32_t rings;        /* around the touched triangle; 3 */
  uint32_t quant_bits;   /* thesis; 8 */
  uint32_t models_kept;  /* thesis; 0 */
  uint32_t layered;      /* main: separate packets for the haptic and the visual layer; 0 */
  uint32_t weight_sets;  /* main; 0: chosen */
  uint32_t spring_modes; /* main: modes of a network of springs that both ends compute; 0 */
  double frame_period;   /* main: ticks from shape to shape; 1 */
  double fade;           /* main, with a basis: share of corrections that fades per second; -1: chosen */
  const uint32_t* fixed; /* spring_modes: vertices that do not move, ascending */
  size_t fixed_count;
  const double* vectors;   /* a basis to declare: modes x vertices x 3, any scale; NULL */
  size_t modes;            /* 0 to 64 */
  const double* stiffness; /* N/m of each vertex, infinite where it does not move; NULL: not told */
  size_t stiffness_count;  /* vertices */
  const uint8_t* clusters; /* a basis of vertices that move alike (tactus_find_clusters): cluster of each vertex; NULL */
  uint32_t cluster_count;  /* 0 to 64: each is below it; 0: none. In place of a basis of other kinds */
  uint32_t blend;          /* rounds in which the clusters are blended where they meet, 0 to 32 */
  /* In sessions, let a participant work out from its own device how the object deforms: profile main, not layered, frame_period a whole
     number up to 1024; NULL: do not. _build checks it: err  R-ELA; R-STR-24 it is too much for a client; R-API-1, 2 an inner vertex */
  const tactus_elastic_physics* elastic;
} tactus_deformable_options;

TACTUS_API tactus_status tactus_scene_builder_create(const tactus_scene_options* options, tactus_scene_builder** builder,
                                                     tactus_error* error);
TACTUS_API void tactus_scene_builder_destroy(tactus_scene_builder* builder);
TACTUS_API tactus_status tactus_scene_builder_rigid(tactus_scene_builder* builder, const char* name,
                                                    const tactus_rigid_options* options, tactus_error* error);
/* in   vertices  x y z of each [m] at rest, world;  triangles  3 corners of each, counter-clockwise seen from outside */
TACTUS_API tactus_status tactus_scene_builder_deformable(tactus_scene_builder* builder, const char* name, const double* vertices,
                                                         size_t vertex_count, const uint32_t* triangles, size_t triangle_count,
                                                         const tactus_deformable_options* options, tactus_error* error);
/* Clusters of vertices that move alike, found on shapes of a recording: 40 are enough, if they are spread over it.
   in   shapes  displacements [m], x y z of vertex 0 first, one shape after the other;  most  1 to 64
   out  clusters  of each vertex, as tactus_deformable_options takes them, like  count, blend
   time about 0.1 us per vertex, shape and cluster   err  R-API-1, 4, 5; R-SRF */
TACTUS_API tactus_status tactus_find_clusters(const double* vertices, size_t vertex_count, const uint32_t* triangles,
                                              size_t triangle_count, const float* shapes, size_t shape_count, uint32_t most,
                                              uint8_t* clusters, uint32_t* count, uint32_t* blend, tactus_error* error);
/* Declare the bounds that hold at a client: those of its sender. NULL: defaults. */
TACTUS_API tactus_status tactus_scene_builder_declare_bounds(tactus_scene_builder* builder, const tactus_rigid_bounds* rigid,
                                                             const tactus_deformable_bounds* deformable,
                                                             const tactus_load_bounds* load, tactus_error* error);
/* Check everything and make the scene. The builder is empty then, also after an error.
   err  with the object that it concerns and figures, which live until the next call of the builder */
TACTUS_API tactus_status tactus_scene_builder_build(tactus_scene_builder* builder, tactus_scene** scene, tactus_error* error);

/* ---------------------------------------------------------------- sender: truth in, packets out */

typedef struct tactus_sender tactus_sender;

enum { TACTUS_REDUCTION_NONE = 0 /* every object at every tick */, TACTUS_REDUCTION_DEAD_RECKONING = 1 };
enum { TACTUS_BASELINE_PREVIOUS = 0, TACTUS_BASELINE_ACKNOWLEDGED = 1 };

typedef struct tactus_sender_options {
  uint32_t size;
  int32_t reduction; /* TACTUS_REDUCTION_...; dead reckoning */
  int32_t baseline;  /* TACTUS_BASELINE_...; previous */
  uint32_t reserved;
  double key_interval;              /* s; 5; 0: never */
  double visual_fraction;           /* deformable, main: a packet corrects errors over this fraction of v; 0: chosen */
  double haptic_fraction;           /* the same of h */
  const tactus_rigid_bounds* rigid; /* NULL: defaults, as the next two */
  const tactus_deformable_bounds* deformable;
  const tactus_load_bounds* load;
} tactus_sender_options;

typedef struct tactus_rigid_sample {
  tactus_pose pose;
  double velocity[3];         /* m/s, world */
  double angular_velocity[3]; /* rad/s, world */
} tactus_rigid_sample;

enum { TACTUS_CONTACT_NONE = 0, TACTUS_CONTACT_SURFACE = 1, TACTUS_CONTACT_SPRING = 2 };

/* A user touches a rigid object. */
typedef struct tactus_contact {
  int32_t kind; /* TACTUS_CONTACT_...: below a face, or tied to a point of the object */
  uint32_t object;
  double point[3];  /* m, object: of the face, or the spring's anchor */
  double normal[3]; /* object, outward, unit length; unused by a spring */
  double device[3]; /* m, world */
  double stiffness; /* N/m */
} tactus_contact;

/* A deformable object at one tick. */
typedef struct tactus_shape {
  const float* displacements; /* x y z of each vertex, m, from rest; NULL: no new shape */
  size_t vertices;
  int32_t touched;   /* 1: the next three count */
  uint32_t triangle; /* nearest to the probe */
  double force;      /* N */
  double stiffness;  /* N/m, of the client's rendering */
} tactus_shape;

typedef struct tactus_truth {
  uint32_t size;
  uint32_t reserved;
  const tactus_rigid_sample* objects; /* one per rigid object of the scene */
  size_t object_count;
  const tactus_contact* contacts; /* any number */
  size_t contact_count;
  const tactus_shape* shapes; /* one per deformable object, or none */
  size_t shape_count;
  const double* loads; /* N, world: per rigid object external, hold, then one per user, x y z each; NULL without loads */
  size_t load_count;   /* objects */
  /* Indices of the objects whose sample is not that of the tick before: what rests then costs nothing. NULL: all are compared. An object that
     moves and is not named is not sent. */
  const uint32_t* moved;
  size_t moved_count;
  /* Of the packets of this tick, above that of any packet before and below 2^62 - 1, as a transport numbers what it sends; a second packet of an
     object has number + 1. 0: each substream counts on, from 1. A server of sessions numbers its packets itself: 0. */
  uint64_t number;
} tactus_truth;

/* What of a truth breaks a rule. It does not stop the others: what it was before is coded, at rest, until it breaks none. */
enum {
  TACTUS_PART_OBJECT =
      0, /* a rigid object: R-API-1 not finite, R-API-2 off the grid, R-API-3 no rotation, R-API-6 off its axes */
  TACTUS_PART_CONTACT = 1, /* a contact that does not count: R-API-1, R-API-15; 16 at most are reported */
  TACTUS_PART_SHAPE = 2,   /* of a deformable object: R-API-1, 2 */
  TACTUS_PART_TOUCH = 3,   /* of a deformable object, which does not count: R-API-1, R-API-15 */
  TACTUS_PART_LOAD = 4     /* of a rigid object: R-API-1, 2 */
};
typedef struct tactus_held {
  uint32_t part;    /* TACTUS_PART_... */
  uint32_t index;   /* of the object, or of the contact */
  int64_t since;    /* tick */
  const char* rule; /* static; tactus_describe has its texts */
  const char* name; /* of the object, "" of a contact; UTF-8, lives as long as the scene */
} tactus_held;

/* A packet that was coded; fields as those of tactus_packet_info. `number` is not in its bytes: the receiver needs both. */
typedef struct tactus_packet {
  const uint8_t* data;
  uint32_t bytes;
  uint32_t substream;
  int64_t tick;
  uint64_t number; /* packets of each substream count from 1 */
  uint32_t kind, key, layer, reason, updates;
  uint32_t reserved;
} tactus_packet;

/* What came of a truth. Arrays live until the next call of the object that made them. */
typedef struct tactus_encoded {
  uint32_t size;
  uint32_t reserved;
  const tactus_packet* packets; /* mostly none */
  size_t packet_count;
  const tactus_held* held; /* parts of the truth that are held, mostly none */
  size_t held_count;
} tactus_encoded;

TACTUS_API tactus_status tactus_sender_create(const tactus_scene* scene, const tactus_sender_options* options,
                                              tactus_sender** sender, tactus_error* error);
TACTUS_API void tactus_sender_destroy(tactus_sender* sender);
/* Evaluate a tick and code the packets it needs.   in  tick  rising
   err  R-API-5 a wrong count or tick. One bad object is no error: encoded.held */
TACTUS_API tactus_status tactus_sender_encode(tactus_sender* sender, int64_t tick, const tactus_truth* truth,
                                              tactus_encoded* encoded, tactus_error* error);
/* A receiver asks for a key packet. */
TACTUS_API tactus_status tactus_sender_request_key(tactus_sender* sender, tactus_error* error);
/* A receiver has decoded a packet: TACTUS_BASELINE_ACKNOWLEDGED builds on it. A number that no packet has is ignored. */
TACTUS_API tactus_status tactus_sender_acknowledge(tactus_sender* sender, uint32_t substream, uint64_t number,
                                                   tactus_error* error);
/* in   ack_timeout  [ticks] until a packet is acknowledged, 0: not known;  loss  fraction of packets */
TACTUS_API tactus_status tactus_sender_set_link(tactus_sender* sender, int64_t ack_timeout, double loss, tactus_error* error);
/* In a scene with interest: where the receiver looks from, from the next tick on. Before the first call it is declared of all in full.
   in   viewpoints  x y z of each [m, world], two at most: others do not count;  count  0: it looks from nowhere that is known */
TACTUS_API tactus_status tactus_sender_set_viewpoints(tactus_sender* sender, const double* viewpoints, size_t count,
                                                      tactus_error* error);

/* ---------------------------------------------------------------- writer: packets into a stream file */

typedef struct tactus_writer tactus_writer;

TACTUS_API tactus_status tactus_writer_create(const tactus_scene* scene, tactus_writer** writer, tactus_error* error);
TACTUS_API void tactus_writer_destroy(tactus_writer* writer);
/* in   tick  not falling;  number, key  as in tactus_packet. A file does not hold numbers: those of each substream are 1, 2, 3 ..
   err  R-API-5 the tick falls, or the number is not the next one: nothing is written */
TACTUS_API tactus_status tactus_writer_add(tactus_writer* writer, int64_t tick, uint64_t number, const uint8_t* packet,
                                           size_t size, uint32_t key, tactus_error* error);
/* Add the index and the end of the file. */
TACTUS_API tactus_status tactus_writer_finish(tactus_writer* writer, tactus_error* error);
/* Take what was written since the last call.   out  size  needed or taken */
TACTUS_API tactus_status tactus_writer_take(tactus_writer* writer, uint8_t* bytes, size_t capacity, size_t* size,
                                            tactus_error* error);

#ifdef __cplusplus
}
#endif

#endif
