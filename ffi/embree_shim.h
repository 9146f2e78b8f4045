/* One small interface over Embree 4 and Embree 3 (see docs/embree.md).
 *
 * Nothing of Embree's own headers shows here: they differ between the two versions, and even between
 * 4.2 and 4.3, so only embree_shim.c, compiled against the header that is installed, may know them.
 *
 * A packet of N rays is eight arrays of N floats, one after the other:
 *     org_x org_y org_z tnear dir_x dir_y dir_z tfar
 * and its hits are three arrays of N floats (t u v) and two of N unsigned (mesh triangle).
 * `active` holds one bit a lane. */
#ifndef WARPATH_EMBREE_SHIM_H
#define WARPATH_EMBREE_SHIM_H

typedef struct WarpathAccel WarpathAccel;

typedef struct WarpathMesh {
    const float *positions; /* three a vertex */
    const unsigned *triangles; /* three a triangle, all below vertex_count */
    unsigned vertex_count;
    unsigned triangle_count;
} WarpathMesh;

typedef struct WarpathOptions {
    int robust;
    int quality; /* of the build: 0 low, 1 medium, 2 high */
    char isa[16]; /* the one instruction set to use, by Embree's name; empty: the best there is */
    unsigned threads; /* for building; 0: as many as Embree likes */
    unsigned width; /* widest packet handed to Embree; 0: the widest native one */
    unsigned long long memory_limit; /* bytes; 0: none */
} WarpathOptions;

/* Codes are Embree's own: 0 is success, 4 out of memory, 5 unsupported CPU. */
typedef struct WarpathError {
    int code;
    char message[252];
} WarpathError;

/* Null on failure, with *error filled in. Mesh i gets geometry id i. */
WarpathAccel *warpath_accel_new(const WarpathMesh *meshes, unsigned mesh_count,
                                const WarpathOptions *options, WarpathError *error);
/* Same mesh and vertex counts as before; only positions are read. Non-zero on failure. */
int warpath_accel_refit(WarpathAccel *accel, const WarpathMesh *meshes, WarpathError *error);
void warpath_accel_free(WarpathAccel *accel);

/* Widest packet this CPU and library handle without emulation: 1, 4, 8 or 16. */
unsigned warpath_accel_native_width(const WarpathAccel *accel);
/* Bytes that Embree holds. */
unsigned long long warpath_accel_memory(const WarpathAccel *accel);
/* Of the library that is loaded, such as 31305 or 40303. */
unsigned warpath_accel_version(const WarpathAccel *accel);

/* Inactive lanes of the hits are left as they were. */
void warpath_intersect1(const WarpathAccel *accel, const float *rays, unsigned active, int coherent,
                        float *tuv, unsigned *ids);
void warpath_intersect4(const WarpathAccel *accel, const float *rays, unsigned active, int coherent,
                        float *tuv, unsigned *ids);
void warpath_intersect8(const WarpathAccel *accel, const float *rays, unsigned active, int coherent,
                        float *tuv, unsigned *ids);
void warpath_intersect16(const WarpathAccel *accel, const float *rays, unsigned active, int coherent,
                         float *tuv, unsigned *ids);

/* One bit a lane whose ray meets anything. */
unsigned warpath_occluded1(const WarpathAccel *accel, const float *rays, unsigned active, int coherent);
unsigned warpath_occluded4(const WarpathAccel *accel, const float *rays, unsigned active, int coherent);
unsigned warpath_occluded8(const WarpathAccel *accel, const float *rays, unsigned active, int coherent);
unsigned warpath_occluded16(const WarpathAccel *accel, const float *rays, unsigned active, int coherent);

/* The floor for benchmarks: puts `packets` packets of n rays, `stride` floats apart, into Embree's own layout
 * and width, then times one pass over them. Seconds, or a negative number if there is no memory. */
double warpath_floor(const WarpathAccel *accel, const float *rays, unsigned n, unsigned stride,
                     unsigned packets, int coherent, unsigned long long *hits);

#endif
