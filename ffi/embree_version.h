/* What differs between Embree 4 and 3, and nothing else. build.rs defines WARPATH_EMBREE. */
#ifndef WARPATH_EMBREE_VERSION_H
#define WARPATH_EMBREE_VERSION_H

#define CALL_(name, W) name##W
#define CALL(name, W) CALL_(name, W)

#if WARPATH_EMBREE == 4

#include <embree4/rtcore.h>

typedef struct RTCIntersectArguments IntersectQuery;
typedef struct RTCOccludedArguments OccludedQuery;

#define QUERY_FLAGS(coherent) ((coherent) ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT)

static inline void init_intersect(IntersectQuery *query, int coherent)
{
    rtcInitIntersectArguments(query);
    query->flags = QUERY_FLAGS(coherent);
}

static inline void init_occluded(OccludedQuery *query, int coherent)
{
    rtcInitOccludedArguments(query);
    query->flags = QUERY_FLAGS(coherent);
}

#define INTERSECT1(scene, query, rayhit) rtcIntersect1(scene, rayhit, query)
#define INTERSECTN(W, scene, query, valid, rayhit) CALL(rtcIntersect, W)(valid, scene, rayhit, query)
#define OCCLUDED1(scene, query, ray) rtcOccluded1(scene, ray, query)
#define OCCLUDEDN(W, scene, query, valid, ray) CALL(rtcOccluded, W)(valid, scene, ray, query)

#else

#include <embree3/rtcore.h>

typedef struct RTCIntersectContext IntersectQuery;
typedef struct RTCIntersectContext OccludedQuery;

static inline void init_intersect(IntersectQuery *query, int coherent)
{
    rtcInitIntersectContext(query);
    query->flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
}

static inline void init_occluded(OccludedQuery *query, int coherent)
{
    init_intersect(query, coherent);
}

#define INTERSECT1(scene, query, rayhit) rtcIntersect1(scene, query, rayhit)
#define INTERSECTN(W, scene, query, valid, rayhit) CALL(rtcIntersect, W)(valid, scene, query, rayhit)
#define OCCLUDED1(scene, query, ray) rtcOccluded1(scene, query, ray)
#define OCCLUDEDN(W, scene, query, valid, ray) CALL(rtcOccluded, W)(valid, scene, query, ray)

#endif
#endif
