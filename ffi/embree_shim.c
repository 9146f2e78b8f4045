#include "embree_shim.h"

#include "embree_version.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct WarpathAccel {
    RTCDevice device;
    RTCScene scene;
    RTCGeometry *geometries; /* null where a mesh has no triangle */
    unsigned mesh_count;
    unsigned width; /* widest packet handed to Embree */
    unsigned native_width;
    int refitting; /* the scene is a two-level one made for refits */
    long long memory, memory_limit; /* bytes; a limit of 0 is none */
    WarpathError error; /* the first one since the last call began */
};

/* ---- Building ---- */

static void on_error(void *accel, enum RTCError code, const char *text)
{
    WarpathError *error = &((WarpathAccel *)accel)->error;
    if (error->code != RTC_ERROR_NONE) return; /* the first is the cause, the rest its echoes */
    error->code = (int)code;
    snprintf(error->message, sizeof error->message, "%s", text ? text : "");
}

static bool on_memory(void *user, ssize_t bytes, bool post)
{
    WarpathAccel *accel = user;
    long long used = __atomic_add_fetch(&accel->memory, (long long)bytes, __ATOMIC_RELAXED);
    (void)post;
    return bytes <= 0 || !accel->memory_limit || used <= accel->memory_limit;
}

static unsigned native_width(RTCDevice device)
{
    if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) return 16;
    if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED)) return 8;
    if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED)) return 4;
    return 1;
}

static void attach(WarpathAccel *accel, const WarpathMesh *mesh, unsigned id)
{
    const size_t stride = 12; /* three floats, or three indices */
    if (mesh->triangle_count == 0) return; /* an id no ray meets */
    RTCGeometry geometry = rtcNewGeometry(accel->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (!geometry) return; /* on_error has been told */
    accel->geometries[id] = geometry;
    void *positions = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, stride,
                                              mesh->vertex_count);
    if (positions)
        memcpy(positions, mesh->positions, stride * mesh->vertex_count);
    else
        on_error(accel, RTC_ERROR_OUT_OF_MEMORY, "no vertex buffer");
    void *triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, stride,
                                              mesh->triangle_count);
    if (triangles)
        memcpy(triangles, mesh->triangles, stride * mesh->triangle_count);
    else
        on_error(accel, RTC_ERROR_OUT_OF_MEMORY, "no index buffer");
    if (accel->error.code != RTC_ERROR_NONE) return;
    rtcSetGeometryMask(geometry, 0xffffffffu); /* Embree 4 begins with bit 0 only, 3 with all */
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(accel->scene, geometry, id);
}

WarpathAccel *warpath_accel_new(const WarpathMesh *meshes, unsigned mesh_count, const WarpathOptions *options,
                                WarpathError *error)
{
    static const enum RTCBuildQuality qualities[] = {RTC_BUILD_QUALITY_LOW, RTC_BUILD_QUALITY_MEDIUM,
                                                     RTC_BUILD_QUALITY_HIGH};
    char config[64];
    WarpathAccel *accel = calloc(1, sizeof *accel);
    RTCGeometry *geometries = calloc(mesh_count + (size_t)1, sizeof *geometries);
    if (!accel || !geometries) {
        free(accel);
        free(geometries);
        error->code = RTC_ERROR_OUT_OF_MEMORY;
        snprintf(error->message, sizeof error->message, "no room for %u geometries", mesh_count);
        return NULL;
    }
    accel->geometries = geometries;
    accel->mesh_count = mesh_count;
    snprintf(config, sizeof config, "threads=%u%s%s", options->threads, options->isa[0] ? ",isa=" : "",
             options->isa);
    accel->device = rtcNewDevice(config);
    if (!accel->device) {
        on_error(accel, rtcGetDeviceError(NULL), "Embree made no device");
        goto failed;
    }
    rtcSetDeviceErrorFunction(accel->device, on_error, accel);
    accel->memory_limit = (long long)options->memory_limit;
    rtcSetDeviceMemoryMonitorFunction(accel->device, on_memory, accel);
    accel->native_width = native_width(accel->device);
    accel->width = options->width ? options->width : accel->native_width;
    accel->scene = rtcNewScene(accel->device);
    if (!accel->scene) goto failed;
    rtcSetSceneFlags(accel->scene, options->robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(accel->scene, qualities[options->quality]);
    for (unsigned i = 0; i < mesh_count && accel->error.code == RTC_ERROR_NONE; i++)
        attach(accel, &meshes[i], i);
    if (accel->error.code == RTC_ERROR_NONE) rtcCommitScene(accel->scene);
    if (accel->error.code == RTC_ERROR_NONE) return accel;
failed:
    *error = accel->error;
    warpath_accel_free(accel);
    return NULL;
}

int warpath_accel_refit(WarpathAccel *accel, const WarpathMesh *meshes, WarpathError *error)
{
    const int first = !accel->refitting;
    accel->error.code = RTC_ERROR_NONE;
    if (first) {
        /* Embree refits only below a two-level hierarchy, which it makes for scenes both dynamic and of low
         * quality (the meshes in it keep their own). A single level traces a little faster, so the scene
         * becomes a two-level one when the first vertex moves; that once, meshes are built anew. */
        accel->refitting = 1;
        rtcSetSceneFlags(accel->scene, rtcGetSceneFlags(accel->scene) | RTC_SCENE_FLAG_DYNAMIC);
        rtcSetSceneBuildQuality(accel->scene, RTC_BUILD_QUALITY_LOW);
        for (unsigned i = 0; i < accel->mesh_count; i++)
            if (accel->geometries[i])
                rtcSetGeometryBuildQuality(accel->geometries[i], RTC_BUILD_QUALITY_REFIT);
    }
    for (unsigned i = 0; i < accel->mesh_count; i++) {
        RTCGeometry geometry = accel->geometries[i];
        const size_t size = 12 * (size_t)meshes[i].vertex_count;
        if (!geometry) continue;
        void *positions = rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
        if (!positions || (!first && memcmp(positions, meshes[i].positions, size) == 0)) continue;
        memcpy(positions, meshes[i].positions, size);
        rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
        rtcCommitGeometry(geometry);
    }
    rtcCommitScene(accel->scene);
    *error = accel->error;
    return accel->error.code;
}

void warpath_accel_free(WarpathAccel *accel)
{
    if (!accel) return;
    for (unsigned i = 0; i < accel->mesh_count; i++)
        if (accel->geometries[i]) rtcReleaseGeometry(accel->geometries[i]);
    if (accel->scene) rtcReleaseScene(accel->scene);
    if (accel->device) rtcReleaseDevice(accel->device);
    free(accel->geometries);
    free(accel);
}

unsigned warpath_accel_native_width(const WarpathAccel *accel)
{
    return accel->native_width;
}

unsigned long long warpath_accel_memory(const WarpathAccel *accel)
{
    return (unsigned long long)accel->memory;
}

unsigned warpath_accel_version(const WarpathAccel *accel)
{
    return (unsigned)rtcGetDeviceProperty(accel->device, RTC_DEVICE_PROPERTY_VERSION);
}

/* ---- Queries ---- */

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* As LARGEST in src/trace/packet.rs; just below Embree's own FLT_LARGE. */
#define LARGEST 1.8e18f

#define W 1
#include "embree_packet.h"
#undef W
#define W 4
#include "embree_packet.h"
#undef W
#define W 8
#include "embree_packet.h"
#undef W
#define W 16
#include "embree_packet.h"
#undef W

/* A packet wider than Embree handles natively goes in native parts: its own emulation is slower. */
#define SPLIT(N, W, DO)                                                                                      \
    {                                                                                                        \
        for (unsigned at = 0; at < N; at += W)                                                               \
            if (active >> at & ((1u << W) - 1u)) DO;                                                         \
    }

#define PACKET(N)                                                                                            \
    void warpath_intersect##N(const WarpathAccel *accel, const float *rays, unsigned active, int coherent,   \
                              float *tuv, unsigned *ids)                                                     \
    {                                                                                                        \
        IntersectQuery query;                                                                                \
        init_intersect(&query, coherent);                                                                    \
        if (N >= 16 && accel->width >= 16)                                                                   \
            SPLIT(N, 16, intersect_part16(accel, rays, active, &query, tuv, ids, N, at))                    \
        else if (N >= 8 && accel->width >= 8)                                                                \
            SPLIT(N, 8, intersect_part8(accel, rays, active, &query, tuv, ids, N, at))                      \
        else if (N >= 4 && accel->width >= 4)                                                                \
            SPLIT(N, 4, intersect_part4(accel, rays, active, &query, tuv, ids, N, at))                      \
        else                                                                                                 \
            SPLIT(N, 1, intersect_part1(accel, rays, active, &query, tuv, ids, N, at))                      \
    }                                                                                                        \
    unsigned warpath_occluded##N(const WarpathAccel *accel, const float *rays, unsigned active,              \
                                 int coherent)                                                               \
    {                                                                                                        \
        OccludedQuery query;                                                                                 \
        unsigned blocked = 0;                                                                                \
        init_occluded(&query, coherent);                                                                     \
        if (N >= 16 && accel->width >= 16)                                                                   \
            SPLIT(N, 16, blocked |= occluded_part16(accel, rays, active, &query, N, at))                    \
        else if (N >= 8 && accel->width >= 8)                                                                \
            SPLIT(N, 8, blocked |= occluded_part8(accel, rays, active, &query, N, at))                      \
        else if (N >= 4 && accel->width >= 4)                                                                \
            SPLIT(N, 4, blocked |= occluded_part4(accel, rays, active, &query, N, at))                      \
        else                                                                                                 \
            SPLIT(N, 1, blocked |= occluded_part1(accel, rays, active, &query, N, at))                      \
        return blocked;                                                                                      \
    }

PACKET(1)
PACKET(4)
PACKET(8)
PACKET(16)

double warpath_floor(const WarpathAccel *accel, const float *rays, unsigned n, unsigned stride,
                     unsigned packets, int coherent, unsigned long long *hits)
{
    unsigned width = n < accel->width ? n : accel->width;
    if (width >= 16) return floor16(accel, rays, n, stride, packets, coherent, hits);
    if (width >= 8) return floor8(accel, rays, n, stride, packets, coherent, hits);
    if (width >= 4) return floor4(accel, rays, n, stride, packets, coherent, hits);
    return floor1(accel, rays, n, stride, packets, coherent, hits);
}
