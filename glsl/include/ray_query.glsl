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
#define ray_query_initialize(q, ray)                                                                                   \
    rayQueryInitializeEXT(q, scene_structure, gl_RayFlagsNoOpaqueEXT, 0xffu, ray.origin, ray.t_min, ray.direction,     \
                          ray.t_max)
#define ray_query_candidate_instance(q) uint(rayQueryGetIntersectionInstanceCustomIndexEXT(q, false))
#define ray_query_candidate_primitive(q)                                                                               \
    (uint(rayQueryGetIntersectionPrimitiveIndexEXT(q, false)) + instances[ray_query_candidate_instance(q)].first_primitive)
#define ray_query_proceed(q, ray, enough)                                                                              \
    while (rayQueryProceedEXT(q)) {                                                                                    \
        if (ray_query_candidate_instance(q) == ray.skip_instance                                                       \
            && ray_query_candidate_primitive(q) == ray.skip_primitive)                                                 \
            continue;                                                                                                  \
        bool ends = rayQueryGetIntersectionTEXT(q, false) < (enough);                                                  \
        rayQueryConfirmIntersectionEXT(q);                                                                             \
        if (ends) rayQueryTerminateEXT(q);                                                                             \
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

void ray_query_initialize(out RayQuery q, Ray ray) {
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

// Codes on the stack that no leaf has: nothing is left; an object is left for the top level.
const uint DONE = 0xffffffffu;
const uint LEAVE = 0xfffffffeu;

// Two nested loops, down to the next leaf and on from it, so that lanes that share their instructions test their leaves
// together. The top of the stack is in a variable: what comes after it is read while the boxes are tested, not when it is
// needed. A hit nearer than `enough` ends it.
void ray_query_proceed(inout RayQuery q, Ray ray, float enough) {
    uint stack[STACK_SIZE];
    stack[0] = DONE;
    uint height = 1u;
    uint top = DONE;
    uint instance = INSTANCES ? NO_INSTANCE : 0u;
    Slope slope = slope_of(ray.origin, ray.direction);
    uint current = push.root;
    while (true) {
        while ((current & LEAF) == 0u) {
            Node node = node_at(current);
            Range range0 = intersect_box(slope, node.lo0.xyz, node.hi0.xyz, ray.t_min, q.t);
            Range range1 = intersect_box(slope, node.lo1.xyz, node.hi1.xyz, ray.t_min, q.t);
            uint child0 = node.lo0.w, child1 = node.hi0.w;
            bool hit0 = range0.enter <= range0.leave;
            bool hit1 = range1.enter <= range1.leave;
            bool first0 = hit0 && (!hit1 || range0.enter <= range1.enter);
            bool both = hit0 && hit1;
            bool none = !hit0 && !hit1;
            // Always written and read; the height says whether it counts.
            stack[height] = top;
            uint below = stack[height - 1u];
            height = height + uint(both) - uint(none);
            current = none ? top : first0 ? child0 : child1;
            top = none ? below : both ? (first0 ? child1 : child0) : top;
        }
        if (current == DONE) return;
        if (INSTANCES && current == LEAVE) {
            instance = NO_INSTANCE;
            slope = slope_of(ray.origin, ray.direction);
        } else if (INSTANCES && instance == NO_INSTANCE) {
            instance = current & LEAF_FIRST;
            stack[height++] = top;
            top = LEAVE;
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
            if (q.committed && q.t < enough) return;
        }
        current = top;
        top = stack[--height];
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

// The closest hit, or any that is nearer than `enough`.
Hit trace_until(Ray ray, float enough) {
    RayQuery query;
    ray_query_initialize(query, ray);
    ray_query_proceed(query, ray, enough);
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

Hit trace_closest(Ray ray) {
    return trace_until(ray, 0.0);
}

bool trace_occluded(Ray ray) {
    RayQuery query;
    ray_query_initialize(query, ray);
    ray_query_proceed(query, ray, 1e38);
    return ray_query_committed(query);
}

#endif
