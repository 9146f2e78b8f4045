/* Queries of W lanes; embree_shim.c includes this once a width, with W defined.
 *
 * Each asks for lanes at .. at+W of a packet of n rays, n >= W. Copying into Embree's layout and out of it
 * is a few dozen vector moves, against thousands of cycles of traversal (docs/embree.md). */

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)

#if W == 1 /* the single ray has plain numbers where packets have arrays, and takes no mask */
#define RAY struct RTCRay
#define RAYHIT struct RTCRayHit
#else
#define RAY struct JOIN(RTCRay, W)
#define RAYHIT struct JOIN(RTCRayHit, W)
#endif

static inline unsigned JOIN(load, W)(RAY *ray, int *valid, const float *rays, unsigned active, unsigned n,
                                     unsigned at)
{
    const size_t size = W * sizeof(float);
    rays += at;
#if W == 1
    /* Embree loads each four as one vector, which waits if they were stored one by one. */
    typedef float Four __attribute__((vector_size(16)));
    Four origin = {rays[0], rays[n], rays[2 * n], rays[3 * n]};
    Four direction = {rays[4 * n], rays[5 * n], rays[6 * n], 0.0f};
    memcpy(&ray->org_x, &origin, sizeof origin);
    memcpy(&ray->dir_x, &direction, sizeof direction); /* and time = 0 */
#else
    memcpy(&ray->org_x, rays, size);
    memcpy(&ray->org_y, rays + n, size);
    memcpy(&ray->org_z, rays + 2 * n, size);
    memcpy(&ray->tnear, rays + 3 * n, size);
    memcpy(&ray->dir_x, rays + 4 * n, size);
    memcpy(&ray->dir_y, rays + 5 * n, size);
    memcpy(&ray->dir_z, rays + 6 * n, size);
    memset(&ray->time, 0, size);
#endif
    memcpy(&ray->tfar, rays + 7 * n, size);
    memset(&ray->mask, 0xff, size);
    memset(&ray->id, 0, size);
    memset(&ray->flags, 0, size);
    /* Embree leaves NaN and numbers beyond LARGEST undefined, or stops the program where it was built with its
     * assertions, as Debian's is: such lanes are not asked, and so miss. Its kernels for SSE 4.2 look at lanes that are
     * not asked, too. */
    unsigned any = 0;
    for (unsigned i = 0; i < W; i++) {
        const float *f = rays + i;
        unsigned sound = f[7 * n] >= f[3 * n];
        for (unsigned c = 0; c < 7; c++) sound &= fabsf(f[c * n]) <= LARGEST;
#if W > 1
        if (!sound) {
            float *lane = (float *)ray + i;
            for (unsigned c = 0; c < 7; c++) lane[c * W] = 0.0f; /* origin, tnear, direction: Embree's first seven */
            ray->tfar[i] = -1.0f;
        }
#endif
        valid[i] = -(int)(active >> (at + i) & sound);
        any |= (unsigned)valid[i];
    }
    return any;
}

static inline void JOIN(intersect_part, W)(const WarpathAccel *accel, const float *rays, unsigned active,
                                           IntersectQuery *query, float *restrict tuv, unsigned *restrict ids,
                                           unsigned n, unsigned at)
{
    RAYHIT rh;
    _Alignas(64) int valid[W];
    unsigned any = JOIN(load, W)(&rh.ray, valid, rays, active, n, at);
    memset(&rh.hit.geomID, 0xff, sizeof rh.hit.geomID); /* RTC_INVALID_GEOMETRY_ID: no hit so far */
    memset(&rh.hit.instID, 0xff, sizeof rh.hit.instID);
#if W == 1
    if (any) INTERSECT1(accel->scene, query, &rh);
#else
    if (any) INTERSECTN(W, accel->scene, query, valid, &rh);
#endif
    const float *tfar = (const float *)&rh.ray.tfar;
    const float *u = (const float *)&rh.hit.u, *v = (const float *)&rh.hit.v;
    const unsigned *mesh = (const unsigned *)&rh.hit.geomID;
    const unsigned *triangle = (const unsigned *)&rh.hit.primID;
    tuv += at;
    ids += at;
    for (unsigned i = 0; i < W; i++) {
        unsigned on = active >> (at + i) & 1u, hit = mesh[i] != RTC_INVALID_GEOMETRY_ID;
        float hit_t = hit ? tfar[i] : INFINITY;
        float hit_u = hit ? u[i] : 0.0f;
        float hit_v = hit ? v[i] : 0.0f;
        unsigned hit_triangle = hit ? triangle[i] : RTC_INVALID_GEOMETRY_ID;
        tuv[i] = on ? hit_t : tuv[i];
        tuv[n + i] = on ? hit_u : tuv[n + i];
        tuv[2 * n + i] = on ? hit_v : tuv[2 * n + i];
        ids[i] = on ? mesh[i] : ids[i];
        ids[n + i] = on ? hit_triangle : ids[n + i];
    }
}

static inline unsigned JOIN(occluded_part, W)(const WarpathAccel *accel, const float *rays, unsigned active,
                                              OccludedQuery *query, unsigned n, unsigned at)
{
    RAY ray;
    _Alignas(64) int valid[W];
    if (!JOIN(load, W)(&ray, valid, rays, active, n, at)) return 0;
#if W == 1
    OCCLUDED1(accel->scene, query, &ray);
#else
    OCCLUDEDN(W, accel->scene, query, valid, &ray);
#endif
    const float *tfar = (const float *)&ray.tfar;
    unsigned blocked = 0;
    for (unsigned i = 0; i < W; i++) /* Embree marks a blocked ray with tfar = -inf */
        blocked |= ((unsigned)valid[i] & (tfar[i] == -INFINITY)) << i;
    return blocked << at;
}

/* See warpath_floor. */
static double JOIN(floor, W)(const WarpathAccel *accel, const float *rays, unsigned n, unsigned stride,
                             unsigned packets, int coherent, unsigned long long *hits)
{
    _Alignas(64) int valid[W];
    size_t count = (size_t)packets * (n / W);
    RAYHIT *all = aligned_alloc(64, (count * sizeof *all + 63) & ~(size_t)63);
    if (!all) return -1.0;
    for (size_t i = 0; i < count; i++) {
        JOIN(load, W)(&all[i].ray, valid, rays + i / (n / W) * stride, ~0u, n, i % (n / W) * W);
        memset(&all[i].hit, 0xff, sizeof all[i].hit);
    }
    memset(valid, 0xff, sizeof valid);
    IntersectQuery query;
    init_intersect(&query, coherent);
    *hits = 0;
    double start = now();
    for (size_t i = 0; i < count; i++) {
        RAYHIT rh = all[i]; /* Embree answers in place, and a program needs its rays again */
#if W == 1
        INTERSECT1(accel->scene, &query, &rh);
#else
        INTERSECTN(W, accel->scene, &query, valid, &rh);
#endif
        const unsigned *mesh = (const unsigned *)&rh.hit.geomID;
        for (unsigned k = 0; k < W; k++)
            *hits += mesh[k] != RTC_INVALID_GEOMETRY_ID;
    }
    double seconds = now() - start;
    free(all);
    return seconds;
}

#undef JOIN_
#undef JOIN
#undef RAY
#undef RAYHIT
