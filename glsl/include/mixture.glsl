// A texel's rays: some by the cosine, some aimed, each weighed by the density of all (one sample model of the balance
// heuristic, with fixed numbers: Veach and Guibas, "Optimally Combining Sampling Techniques", SIGGRAPH 1995).
#ifndef MIXTURE_GLSL
#define MIXTURE_GLSL

#include "importance.glsl"
#include "radiance.glsl"
#include "sampling.glsl"

// Of a texel that is half covered one ray in 2^16 does without.
const uint FOOTPRINT_TRIES = 16u;

// A point of the texel that lies on its triangle and within its footprint.
vec2 choose_point(Surface s, vec4 sides, uint texel, uint sample_index, vec2 u) {
    for (uint attempt = 1u; attempt <= FOOTPRINT_TRIES; ++attempt) {
        vec2 p = mix(sides.xy, sides.zw, u);
        if (on_triangle(s, p)) return p;
        u = random4(texel, sample_index, attempt).xy;
    }
    return clamp(s.start, sides.xy, sides.zw);
}

// A texel and what its rays have in common.
struct Receiver {
    Surface surface;
    mat3 frame;
    vec4 sides;
    uint key;
    uint place;          // in the list of texels
    uint row;            // of its group, where there are clusters
    float source_total;  // of the pyramid, where there are none
    float sky_total;     // of the sky's pyramid
};

// What a ray must find.
struct Aim {
    uint technique;
    Target target;
};

const uint BY_COSINE = 0u;
const uint BY_SOURCE = 1u;
const uint BY_SKY = 2u;

// What rays tell of other mixtures than theirs: the second moment of a ray of each, in units of the mean luminance,
// and how many aimed rays found what they were aimed at. `hits`, `misses`: for cosine alone, and with the shares of
// OTHERS; src/sampling.rs chooses by them.
struct Evidence {
    vec3 hits;
    vec3 misses;
    float seen;
    float sky_seen;
};

const Evidence NOTHING = Evidence(vec3(0.0), vec3(0.0), 0.0, 0.0);

// Shares of the cosine, and of the technique that found what was seen.
const vec3 COSINES = SKY_MAP ? vec3(1.0, 0.5, 0.5) : vec3(1.0, 0.5, 0.25);
const vec3 OTHERS = SKY_MAP ? vec3(0.0, 0.5, 0.25) : vec3(0.0, 0.5, 0.75);
const vec3 LUMINANCE = vec3(0.2126, 0.7152, 0.0722);

// Where ray `index` of a quantum goes; false: nowhere, and no ray is traced. Techniques take turns, each over strata of
// its own.
bool aim_ray(Receiver r, uint index, uint sample_index, out Ray ray, out Aim aim) {
    uint cosine_rays = push.rays - push.source_rays - push.sky_rays;
    vec4 u = random4(r.key, sample_index, 0u);
    vec3 point = point_at(r.surface, choose_point(r.surface, r.sides, r.key, sample_index, u.zw));
    ray = ray_from(r.surface, point, vec3(0.0), 0.0);
    aim.technique = index < cosine_rays ? BY_COSINE : index < cosine_rays + push.source_rays ? BY_SOURCE : BY_SKY;
    bool aimed = true;
    if (!IMPORTANCE || aim.technique == BY_COSINE) {
        ray.direction = r.frame * cosine_direction(stratified(index, cosine_rays, u.xy));
        ray.t_max = 1e30;
    } else {
        vec4 v = random4(r.key, sample_index, WALK_DIMENSION - 1u);
        v.x += v.z / 16777216.0;
        if (aim.technique == BY_SOURCE) {
            float choice = (float(index - cosine_rays) + v.x) / float(push.source_rays);
            aimed = choose_source(r.row, choice, v.w, r.key, sample_index, aim.target)
                    && aim_at_texel(vec3(u.xy, v.y), ray, aim.target);
        } else {
            float choice = (float(index - cosine_rays - push.source_rays) + v.x) / float(push.sky_rays);
            aimed = SKY_MAP && aim_at_sky(choice, u.xy, r.key, sample_index, ray);
        }
    }
    // Under the triangle, where only the shading normal looks, or under the horizon: nothing comes from there.
    return aimed && dot(ray.direction, r.surface.geometric_normal) > 0.0 && dot(ray.direction, r.surface.normal) > 0.0;
}

// What a ray brings to a quantum's irradiance: radiance times weight. `texel`: of the source map, where it was read there.
struct Arrival {
    vec3 radiance;
    float weight;
    uint texel;
};

const uint NO_TEXEL = 0xffffffffu;
const Arrival NO_ARRIVAL = Arrival(vec3(0.0), 0.0, NO_TEXEL);

// The weight is the cosine over the density of all the quantum's rays.
Arrival weigh(Receiver r, Hit hit, vec3 direction, Aim aim, inout Evidence evidence) {
    vec2 place = hit.committed ? place_of_hit(hit) : vec2(0.0);
    Arrival arrival;
    arrival.radiance = hit.committed ? on_hit(hit, ivec2(place)) : on_miss(direction);
    arrival.weight = PI / float(push.rays);
    bool cached = LINKS && hit.committed && !is_black_back(hit) && is_mapped(hit);
    arrival.texel = cached ? uint(place.x) | uint(place.y) << 16u : NO_TEXEL;
    if (!IMPORTANCE || push.source_rays + push.sky_rays == 0u) return arrival;
    float cosine = dot(direction, r.surface.normal);
    float rays = float(hit.committed ? push.source_rays : push.sky_rays);
    float aimed = 0.0;
    if (hit.committed && is_mapped(hit)) aimed = source_density(hit, place, direction, r.row, r.source_total);
    if (SKY_MAP && !hit.committed) aimed = sky_density(direction, r.sky_total);
    if (aim.technique != BY_COSINE) {
        // A line of sight counts where it finds the very texel.
        bool found = hit.committed == (aim.technique == BY_SOURCE) && aimed > 0.0;
        if (!found || aim.technique == BY_SOURCE && !is_target(hit, place, aim.target)) return NO_ARRIVAL;
        if (aim.technique == BY_SOURCE) evidence.seen += 1.0;
        else evidence.sky_seen += 1.0;
    }
    float density = float(push.rays - push.source_rays - push.sky_rays) * (cosine / PI) + rays * aimed;
    if (!(density > 0.0)) return NO_ARRIVAL;
    float part = dot(arrival.radiance, LUMINANCE) * cosine * (push.mean_luminance > 0.0 ? 1.0 / push.mean_luminance : 1.0);
    vec3 moments = part * part / density / (COSINES * (cosine / PI) + OTHERS * aimed);
    if (hit.committed || !SKY_MAP) evidence.hits += moments;
    else evidence.misses += moments;
    arrival.weight = cosine / density;
    return arrival;
}

#endif
