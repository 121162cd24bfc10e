// One façade over two back ends, in the shape of GL_EXT_ray_query: initialise, proceed, then ask for the committed
// hit. All geometry is opaque but for the one triangle that a ray starts from. Only this file knows which back end it is.
//
// `primitive` is the triangle's place in the one list of all meshes. Included first: an extension is asked for before
// anything else.
#ifndef RAY_QUERY_GLSL
#define RAY_QUERY_GLSL

#ifdef RAY_QUERY_HARDWARE
#extension GL_EXT_ray_query : require
#endif

#include "layout.glsl"

const uint NO_INSTANCE = 0xffffffffu;

// What a query asks for.
struct Ray {
    vec3 origin;
    float t_min;
    vec3 direction;
    float t_max;
    uint skip_instance;   // the triangle that the ray starts from, or NO_INSTANCE
    uint skip_primitive;
};

#ifdef RAY_QUERY_HARDWARE

#include "scene.glsl"

layout(set = 0, binding = 0) uniform accelerationStructureEXT scene_structure;

#define RayQuery rayQueryEXT
#define ray_query_initialize(q, ray, any_hit)                                                                          \
    rayQueryInitializeEXT(q, scene_structure,                                                                          \
                          gl_RayFlagsNoOpaqueEXT | ((any_hit) ? gl_RayFlagsTerminateOnFirstHitEXT : gl_RayFlagsNoneEXT), \
                          0xffu, ray.origin, ray.t_min, ray.direction, ray.t_max)
#define ray_query_candidate_instance(q) uint(rayQueryGetIntersectionInstanceCustomIndexEXT(q, false))
#define ray_query_candidate_primitive(q)                                                                               \
    (uint(rayQueryGetIntersectionPrimitiveIndexEXT(q, false)) + instances[ray_query_candidate_instance(q)].first_primitive)
#define ray_query_proceed(q, ray)                                                                                      \
    while (rayQueryProceedEXT(q)) {                                                                                    \
        if (ray_query_candidate_instance(q) != ray.skip_instance                                                       \
            || ray_query_candidate_primitive(q) != ray.skip_primitive)                                                 \
            rayQueryConfirmIntersectionEXT(q);                                                                         \
    }
#define ray_query_committed(q) (rayQueryGetIntersectionTypeEXT(q, true) != gl_RayQueryCommittedIntersectionNoneEXT)
#define ray_query_t(q) rayQueryGetIntersectionTEXT(q, true)
#define ray_query_instance(q) uint(rayQueryGetIntersectionInstanceCustomIndexEXT(q, true))
#define ray_query_primitive(q)                                                                                         \
    (uint(rayQueryGetIntersectionPrimitiveIndexEXT(q, true)) + instances[ray_query_instance(q)].first_primitive)
#define ray_query_barycentrics(q) rayQueryGetIntersectionBarycentricsEXT(q, true)
#define ray_query_front_face(q) rayQueryGetIntersectionFrontFaceEXT(q, true)

#else

#include "bvh.glsl"

struct RayQuery {
    bool any_hit;
    bool committed;
    float t;
    uint instance;
    uint primitive;
    vec2 barycentrics;
    bool front_face;
};

#define ray_query_committed(q) q.committed
#define ray_query_t(q) q.t
#define ray_query_instance(q) q.instance
#define ray_query_primitive(q) q.primitive
#define ray_query_barycentrics(q) q.barycentrics
#define ray_query_front_face(q) q.front_face

void ray_query_initialize(out RayQuery q, Ray ray, bool any_hit) {
    q.any_hit = any_hit;
    q.committed = false;
    q.t = ray.t_max;
    q.instance = 0u;
    q.primitive = 0u;
    q.barycentrics = vec2(0.0);
    q.front_face = false;
}

void test_leaf(inout RayQuery q, Ray ray, Slope slope, uint leaf, uint instance) {
    uint first = leaf & LEAF_FIRST;
    uint last = first + ((leaf >> 26u) & 7u);
    for (uint primitive = first; primitive <= last; ++primitive) {
        Candidate hit = intersect_triangle(slope, primitive, ray.t_min, q.t);
        bool origin = primitive == ray.skip_primitive && instance == ray.skip_instance;
        if (hit.hit && !origin) {
            q.committed = true;
            q.t = hit.t;
            q.instance = instance;
            q.primitive = primitive;
            q.barycentrics = hit.barycentrics;
            q.front_face = hit.front_face;
        }
    }
}

void ray_query_proceed(inout RayQuery q, Ray ray) {
    uint stack[STACK_SIZE];
    uint height = 0u;
    uint object_height = 0u;  // of the stack where the object in hand was entered
    uint instance = INSTANCES ? NO_INSTANCE : 0u;
    Slope slope = slope_of(ray.origin, ray.direction);
    uint current = push.root;
    while (true) {
        if ((current & LEAF) == 0u) {
            Node node = nodes[current];
            vec3 lo0 = fma(node.lo0, slope.inverse, -slope.origin_inverse);
            vec3 hi0 = fma(node.hi0, slope.inverse, -slope.origin_inverse);
            vec3 lo1 = fma(node.lo1, slope.inverse, -slope.origin_inverse);
            vec3 hi1 = fma(node.hi1, slope.inverse, -slope.origin_inverse);
            vec3 near0 = min(lo0, hi0), far0 = max(lo0, hi0);
            vec3 near1 = min(lo1, hi1), far1 = max(lo1, hi1);
            float enter0 = max(max(near0.x, near0.y), max(near0.z, ray.t_min));
            float enter1 = max(max(near1.x, near1.y), max(near1.z, ray.t_min));
            float leave0 = min(min(far0.x, far0.y), min(far0.z, q.t)) * FAR_SLACK;
            float leave1 = min(min(far1.x, far1.y), min(far1.z, q.t)) * FAR_SLACK;
            bool hit0 = enter0 <= leave0;
            bool hit1 = enter1 <= leave1;
            bool first0 = hit0 && (!hit1 || enter0 <= enter1);
            // Always written; the height moves only where both were hit.
            stack[height] = first0 ? node.child1 : node.child0;
            height += uint(hit0 && hit1);
            current = first0 ? node.child0 : node.child1;
            if (hit0 || hit1) continue;
        } else if (INSTANCES && instance == NO_INSTANCE) {
            instance = current & LEAF_FIRST;
            object_height = height;
            vec4 o = vec4(ray.origin, 1.0);
            vec3 d = ray.direction;
            vec4 x = instances[instance].world_to_object[0];
            vec4 y = instances[instance].world_to_object[1];
            vec4 z = instances[instance].world_to_object[2];
            slope = slope_of(vec3(dot(x, o), dot(y, o), dot(z, o)), vec3(dot(x.xyz, d), dot(y.xyz, d), dot(z.xyz, d)));
            current = instances[instance].root;
            continue;
        } else {
            test_leaf(q, ray, slope, current, instance);
            if (q.any_hit && q.committed) return;
        }
        if (INSTANCES && instance != NO_INSTANCE && height == object_height) {
            instance = NO_INSTANCE;
            slope = slope_of(ray.origin, ray.direction);
        }
        if (height == 0u) return;
        current = stack[--height];
    }
}

#endif

struct Hit {
    bool committed;
    float t;
    uint instance;
    uint primitive;
    vec2 barycentrics;
    bool front_face;
};

Hit trace_closest(Ray ray) {
    RayQuery query;
    ray_query_initialize(query, ray, false);
    ray_query_proceed(query, ray);
    Hit hit;
    hit.committed = ray_query_committed(query);
    if (!hit.committed) return Hit(false, ray.t_max, 0u, 0u, vec2(0.0), false);
    hit.t = ray_query_t(query);
    hit.instance = ray_query_instance(query);
    hit.primitive = ray_query_primitive(query);
    hit.barycentrics = ray_query_barycentrics(query);
    hit.front_face = ray_query_front_face(query);
    return hit;
}

bool trace_occluded(Ray ray) {
    RayQuery query;
    ray_query_initialize(query, ray, true);
    ray_query_proceed(query, ray);
    return ray_query_committed(query);
}

#endif
