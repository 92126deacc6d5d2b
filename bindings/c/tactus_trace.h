/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Traces in C, of a library of their own (libtactus-trace): recordings in MCAP, and the error of what a client shows against them. What
 * this library and libtactus hand to each other are structs and bytes, never objects. See tactus.h, whose rules hold here too, and
 * <tactus/trace/trace_file.h>.
 */
#ifndef TACTUS_TRACE_H
#define TACTUS_TRACE_H

#include "tactus_encoder.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---------------------------------------------------------------- trace */

typedef struct tactus_trace tactus_trace;

typedef struct tactus_trace_info {
  uint32_t size;
  uint32_t tick_rate; /* per second */
  uint32_t objects, users, meshes;
  uint32_t has_frames; /* 1: the file states how many frames it has */
  uint64_t frames;
  const char* source; /* "sim push-1dof seed 1"; UTF-8, like all names; they live as long as the trace */
  uint32_t cut_short; /* 1: the file ends early; valid at the end */
  uint32_t reserved;
} tactus_trace_info;

/* These three are answers of a reader, and what a writer takes. */
typedef struct tactus_trace_object {
  uint32_t size;
  uint32_t dof; /* TACTUS_DOF_... */
  const char* name;
} tactus_trace_object;

/* Forces of a user that a trace knows, bits. A server does not receive what was rendered to a hand, nor a client what the server rendered. */
enum { TACTUS_FORCE_RENDERED = 1, TACTUS_FORCE_SERVER = 2 };

typedef struct tactus_trace_user {
  uint32_t size;
  uint32_t senses; /* of the device, beside its position: 1 orientation, 2 velocity, 4 buttons, 8 time */
  const char* name;
  uint32_t forces; /* that are known: TACTUS_FORCE_..., one or both */
  uint32_t reserved;
} tactus_trace_user;

typedef struct tactus_trace_mesh {
  uint32_t size;
  uint32_t vertices, triangles;
  uint32_t fixed; /* answers only: vertices that cannot move */
  double period;  /* nominal ticks from shape to shape */
  const char* name;
  const double* rest;      /* x y z of each vertex at rest, m, world; of an answer they live as long as the trace */
  const uint32_t* corners; /* 3 of each triangle, counter-clockwise seen from outside; likewise */
} tactus_trace_mesh;

/* A user at one tick. */
typedef struct tactus_user_sample {
  tactus_device_sample device;
  tactus_contact contact; /* with a rigid object */
  double force[3];        /* N, world: rendered to the hand; without TACTUS_FORCE_RENDERED the server's */
  double server_force[3]; /* N, world: rendered at the server from the true state; without TACTUS_FORCE_SERVER 0 */
  int32_t touches_mesh;   /* 1: the next ones count */
  uint32_t mesh, triangle;
  uint32_t reserved;
  double weights[3];     /* of the triangle's corners at the touched point */
  double proxy[3];       /* m, world */
  double mesh_normal[3]; /* world, outward */
  double mesh_stiffness; /* N/m */
} tactus_user_sample;

/* How a trace becomes a scene. */
typedef struct tactus_trace_coding {
  uint32_t size;
  uint32_t rigid_profile;      /* main; as tactus_scene_options */
  uint32_t deformable_profile; /* main; as tactus_deformable_options */
  uint32_t baselines;          /* 1 */
  uint32_t spring_modes;       /* 0; as tactus_deformable_options */
  uint32_t clusters;           /* of each mesh at most, found on the trace, which is read once more: not from a pipe; 0: none */
  const tactus_rigid_bounds* rigid; /* that the scene declares; NULL: defaults */
  const tactus_deformable_bounds* deformable;
  double world_size; /* m; 0; as tactus_scene_options */
} tactus_trace_coding;

enum { TACTUS_TRACE_CODING = 1, TACTUS_ERRORS_OPTIONS = 2 };
/* As tactus_init, of a tactus_trace_coding or tactus_errors_options. */
TACTUS_API tactus_status tactus_trace_init(int32_t kind, void* options, size_t size);

/* Open a file, or its bytes in memory that outlives the trace.   in  path  "-": standard input; NULL: bytes   err  R-TRC, with its detail */
TACTUS_API tactus_status tactus_trace_open(const char* path, const uint8_t* bytes, size_t size, tactus_trace** trace,
                                           tactus_error* error);
TACTUS_API void tactus_trace_destroy(tactus_trace* trace);
TACTUS_API tactus_status tactus_trace_get(const tactus_trace* trace, tactus_trace_info* info, tactus_error* error);
TACTUS_API tactus_status tactus_trace_get_object(const tactus_trace* trace, uint32_t object, tactus_trace_object* info,
                                                 tactus_error* error);
TACTUS_API tactus_status tactus_trace_get_user(const tactus_trace* trace, uint32_t user, tactus_trace_user* info,
                                               tactus_error* error);
TACTUS_API tactus_status tactus_trace_get_mesh(const tactus_trace* trace, uint32_t mesh, tactus_trace_mesh* info,
                                               tactus_error* error);
/* The scene of the trace, as bytes for tactus_scene_parse. Before the first call of tactus_trace_next.   out  size  needed or written */
TACTUS_API tactus_status tactus_trace_scene(const tactus_trace* trace, const tactus_trace_coding* coding, uint8_t* bytes,
                                            size_t capacity, size_t* size, tactus_error* error);
/* Go to the next frame; TACTUS_NOTHING at the end.   in  counts  those of the trace, or 0 for what is not wanted */
TACTUS_API tactus_status tactus_trace_next(tactus_trace* trace, int64_t* tick, tactus_rigid_sample* objects, size_t object_count,
                                           tactus_user_sample* users, size_t user_count, tactus_error* error);
/* The mesh in this frame, as tactus_sender_encode takes it. Displacements are NULL when the shape is not new; they live until the next
   call of tactus_trace_next. */
TACTUS_API tactus_status tactus_trace_shape(const tactus_trace* trace, uint32_t mesh, tactus_shape* shape, tactus_error* error);

/* ---------------------------------------------------------------- trace writer */

typedef struct tactus_trace_writer tactus_trace_writer;

/* Declare objects, users and meshes, then add ticks. in   path  "-": standard output;  tick_rate  per second;  source  NULL: "" */
TACTUS_API tactus_status tactus_trace_writer_create(const char* path, uint32_t tick_rate, const char* source,
                                                    tactus_trace_writer** writer, tactus_error* error);
/* A writer destroyed without _finish leaves a readable file without an index, if it has a tick. */
TACTUS_API void tactus_trace_writer_destroy(tactus_trace_writer* writer);
/* One more object, user or mesh; NULL: none.   err  R-API-5 after the first tick; R-API-4 no such axis or bit, or no force */
TACTUS_API tactus_status tactus_trace_writer_declare(tactus_trace_writer* writer, const tactus_trace_object* object,
                                                     const tactus_trace_user* user, const tactus_trace_mesh* mesh,
                                                     tactus_error* error);
/* The first call makes the file.   in  tick  rising, 0 or more;  counts  of all that were declared;  shapes  NULL displacements: not new
   err  R-TRC-1, 11, 17; R-API-1, 5, 6 */
TACTUS_API tactus_status tactus_trace_writer_add(tactus_trace_writer* writer, int64_t tick, const tactus_rigid_sample* objects,
                                                 size_t object_count, const tactus_user_sample* users, size_t user_count,
                                                 const tactus_shape* shapes, size_t shape_count, tactus_error* error);
/* Write index and end.   err  R-API-5 no tick was added */
TACTUS_API tactus_status tactus_trace_writer_finish(tactus_trace_writer* writer, tactus_error* error);

/* ---------------------------------------------------------------- arrays: whole recordings, evenly spaced in time or not */

typedef struct tactus_arrays tactus_arrays;

/* Everything that is handed over stays the caller's and lives until _write. A sample that is not a number, or a rotation of length 0, is
   missing: <tactus/trace/array_trace.h> says what becomes of it, and of times with jitter.
   in   time  [ns] of each row, not falling; INT64_MIN: missing;  tick_rate  per second, 0: found from the times;  gap  s; longest to interpolate
        over, 0: 0.1 */
TACTUS_API tactus_status tactus_arrays_create(const int64_t* time, size_t rows, uint32_t tick_rate, double gap,
                                              const char* source, tactus_arrays** arrays, tactus_error* error);
TACTUS_API void tactus_arrays_destroy(tactus_arrays* arrays);
/* Rows of an object, world frame.   in  position  3 per row [m];  rotation  4 per row, w x y z, any length, NULL: it does not turn;
   velocity  3 per row [m/s];  angular_velocity  3 per row [rad/s]; NULL: from the poses */
TACTUS_API tactus_status tactus_arrays_object(tactus_arrays* arrays, const char* name, const double* position,
                                              const double* rotation, const double* velocity, const double* angular_velocity,
                                              tactus_error* error);
/* Rows of a user, world frame.   in  device  3 per row [m];  rotation  of the device, 4 per row, w x y z, any length; NULL: not known;
   force  3 per row [N] on the user; device or force may be NULL */
TACTUS_API tactus_status tactus_arrays_user(tactus_arrays* arrays, const char* name, const double* device, const double* rotation,
                                            const double* force, tactus_error* error);
/* What a user touched, so that its forces have a bound: at each tick the force stretches a spring between the device and the object.
   in   stiffness  N/m;  kind  TACTUS_CONTACT_SURFACE: what lies along the force counts; _SPRING: the whole vector, as of a grip;
   at_origin  1: the force acts at the object's origin, of a user without a device   err  R-API-5, 4: when it is written */
TACTUS_API tactus_status tactus_arrays_contact(tactus_arrays* arrays, const char* user, const char* object, double stiffness,
                                               int32_t kind, int32_t at_origin, tactus_error* error);
/* Write a trace.   out  notes  NULL: not wanted. What was decided: lines "where: what (count; first location)", also of an error, whose
   detail is the last one. They live until the next call   err  R-CSV-4, 5, 7, 8; R-TRC-1, 11, 17; R-API-1, 2 */
TACTUS_API tactus_status tactus_arrays_write(tactus_arrays* arrays, const char* path, const char** notes, tactus_error* error);

/* ---------------------------------------------------------------- errors of what a client shows */

typedef struct tactus_errors tactus_errors;

typedef struct tactus_errors_options {
  uint32_t size;
  uint32_t rings;        /* deformable: 3: size of the area of interest around the touched triangle */
  uint32_t position_exp; /* deformable: 22: grid of the stream */
  uint32_t reserved;
  const tactus_rigid_bounds* rigid; /* to compare with; NULL: defaults */
  const tactus_deformable_bounds* deformable;
} tactus_errors_options;

enum {
  TACTUS_ERROR_POSITION = 0,  /* m, against visual_position */
  TACTUS_ERROR_ROTATION = 1,  /* rad, against visual_rotation */
  TACTUS_ERROR_FORCE = 2,     /* N, of the contact itself, against the haptic rule */
  TACTUS_ERROR_PERCEIVED = 3, /* N, the same errors against what people notice */
  TACTUS_ERROR_SHAPE = 4      /* m, of the vertices of a mesh, against v and h */
};

typedef struct tactus_error_summary {
  uint32_t size;
  uint32_t reserved;
  uint64_t ticks;       /* with a sample; shape: with a new one */
  uint64_t ticks_over;  /* with one over its bound; shape: 0 */
  uint64_t longest_run; /* ticks: of such ticks; shape: 0 */
  double rms, max;
  double worst_ratio;  /* force, shape: largest error over the permitted one; else 0 */
  uint64_t vertices;   /* shape: compared, in all ticks */
  uint64_t violations; /* shape: of them over their bound */
} tactus_error_summary;

TACTUS_API tactus_status tactus_errors_create(const tactus_trace* truth, const tactus_errors_options* options,
                                              tactus_errors** errors, tactus_error* error);
TACTUS_API void tactus_errors_destroy(tactus_errors* errors);
/* Compare with the trace's frame.   in  poses  as shown, one per object, or NULL;  shapes  as shown, one per mesh, or NULL: of each its
   displacements count, and only where the mesh is new in the frame; NULL displacements: not shown */
TACTUS_API tactus_status tactus_errors_add(tactus_errors* errors, const tactus_trace* truth, const tactus_pose* poses,
                                           size_t pose_count, const tactus_shape* shapes, size_t shape_count,
                                           tactus_error* error);
/* in   quantity  TACTUS_ERROR_...;  mesh  of TACTUS_ERROR_SHAPE; else it does not count */
TACTUS_API tactus_status tactus_errors_get(const tactus_errors* errors, uint32_t quantity, uint32_t mesh,
                                           tactus_error_summary* summary, tactus_error* error);

#ifdef __cplusplus
}
#endif

#endif
