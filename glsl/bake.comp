#version 460
// Gathers light: rays from every texel, whose hits read the source map. In the words of Wizard: a ray is emitted with a
// weight, its hit or miss adds weight times radiance, and the accumulator averages; a ray never spawns another.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "include/rays.glsl"
#include "include/random.glsl"
#include "include/sampling.glsl"
#include "include/texels.glsl"
#include "include/mixture.glsl"
#include "include/links.glsl"

layout(set = 0, binding = 9, r32ui) readonly uniform uimage2D footprint_image;
// Mean irradiance of the even and of the odd quanta, and how many samples each holds. Dynamic: the running average, and
// what the last visit gathered; both with their quanta.
layout(set = 0, binding = 11, rgba32f) uniform image2D mean_even;
layout(set = 0, binding = 12, rgba32f) uniform image2D mean_odd;
// What this dispatch tells of the mixtures: see Evidence.
layout(set = 0, binding = 29, rgba32f) writeonly uniform image2D evidence_image;
layout(set = 0, binding = 30, rgba32f) writeonly uniform image2D sky_evidence_image;

// What rays that were aimed at a cluster from a group of texels have found: as src/pass/clusters.rs has it.
layout(set = 0, binding = 39, std430) buffer Sightings { uint sightings[]; };

// `[work group of the whole list]`: a bit for each field, whether its texels take rays. A dynamic scene has none.
layout(set = 0, binding = 42, std430) readonly buffer Activity { uint activity[]; };

const uint TRIED = 1u;
const uint SEEN = 1u << 16u;

// How far along a line of sight any hit blocks it, of its whole length.
const float SIGHT = 0.998;

// What a ray brings. `tells`: whether it says what it sees of the cluster that it was aimed at.
Arrival shoot(Receiver r, uint index, uint sample_index, bool tells, inout Evidence evidence) {
    Ray ray;
    Aim aim;
    bool traced = aim_ray(r, index, sample_index, ray, aim);
    // One under the horizon has seen nothing either.
    tells = tells && aim.technique == BY_SOURCE;
    uint sighting = r.row + aim.target.cluster;
    if (tells) atomicAdd(sightings[sighting], TRIED);
    if (!traced) return NO_ARRIVAL;
    // Many lines of sight are blocked, which any hit tells; what the others find is at their end.
    float enough = IMPORTANCE && aim.technique == BY_SOURCE ? SIGHT * ray.t_max : 0.0;
    Hit hit = trace_until(ray, enough);
    if (IMPORTANCE && hit.committed && hit.t < enough) return NO_ARRIVAL;
    float seen = evidence.seen;
    Arrival arrival = weigh(r, hit, ray.direction, aim, evidence);
    if (tells && evidence.seen > seen) atomicAdd(sightings[sighting], SEEN);
    return arrival;
}

// Mean irradiance of a quantum. `unlinked`: of it what was not read from the source map, where links are kept.
vec3 gather(Receiver r, uint quantum, inout Evidence evidence, inout vec3 unlinked) {
    uint first = push.first_sample + quantum * push.rays;
    bool tells = VISIBILITY && quantum == push.evidence_quantum && push.step_texels > 0u
                 && (r.key * 2654435761u >> 16u) % max(push.step_texels, 1u) == 0u;
    vec3 sum = vec3(0.0);
    for (uint index = 0u; index < push.rays; ++index) {
        Arrival arrival = shoot(r, index, first + index, tells, evidence);
        vec3 irradiance = arrival.radiance * arrival.weight;
        sum += irradiance;
        if (LINKS && push.link_stride > 0u) {
            bool linked = arrival.texel != NO_TEXEL;
            links[link_place(r.place, index)] = linked ? Link(arrival.texel, arrival.weight) : Link(0u, 0.0);
            if (!linked) unlinked += irradiance;
        }
    }
    return sum;
}

// What a quantum's rays tell: relative variances of a ray, and shares of aimed rays that found their aim.
void store_evidence(ivec2 texel, Evidence evidence, vec3 irradiance) {
    float mean = push.mean_luminance > 0.0 ? push.mean_luminance : 1.0;
    float relative = dot(irradiance, LUMINANCE) / mean;
    float scale = relative * relative + (push.mean_luminance > 0.0 ? 0.01 : 0.0);
    float weight = scale > 0.0 ? 1.0 / scale : 0.0;
    vec3 hits = evidence.hits * weight - (scale > 0.0 ? relative * relative / scale : 0.0);
    vec3 misses = evidence.misses * weight;
    // A texel of which nothing can be told has no say.
    if (any(isnan(hits + misses)) || any(isinf(hits + misses))) hits = misses = vec3(0.0);
    imageStore(evidence_image, texel, vec4(hits, evidence.seen / float(max(push.source_rays, 1u))));
    if (!SKY_MAP) return;
    imageStore(sky_evidence_image, texel, vec4(misses, evidence.sky_seen / float(max(push.sky_rays, 1u))));
}

// Merges a quantum's mean into the running one: no sum that outgrows its addends.
void accumulate(inout vec4 mean, vec3 quantum_mean, float samples) {
    mean.w += samples;
    mean.rgb += (quantum_mean - mean.rgb) * (samples / mean.w);
}

// Static: the halves. The first quantum starts anew: what an earlier epoch left stays readable until then.
vec3 gather_halves(Receiver r, ivec2 texel, inout Evidence evidence) {
    bool anew = push.first_quantum == 0u;
    vec4 even = anew ? vec4(0.0) : imageLoad(mean_even, texel);
    vec4 odd = anew || !HALVES ? vec4(0.0) : imageLoad(mean_odd, texel);
    float samples = float(push.rays);
    vec3 unlinked = vec3(0.0);
    for (uint quantum = push.first_quantum; quantum < push.first_quantum + push.quantum_count; ++quantum) {
        Evidence told = NOTHING;
        vec3 quantum_mean = gather(r, quantum, told, unlinked);
        if (quantum == push.evidence_quantum) evidence = told;
        if (!HALVES || (quantum & 1u) == 0u) accumulate(even, quantum_mean, samples);
        else accumulate(odd, quantum_mean, samples);
    }
    imageStore(mean_even, texel, even);
    // One quantum alone: the odd half is free, and weighs nothing.
    if (LINKS && push.link_stride > 0u) odd.rgb = unlinked;
    if (HALVES || LINKS) imageStore(mean_odd, texel, odd);
    return mix(even.rgb, odd.rgb, odd.w / max(even.w + odd.w, 1.0));
}

// Dynamic: the running average (src/temporal.rs), and beside it what this visit alone has gathered.
vec3 gather_average(Receiver r, ivec2 texel, inout Evidence evidence) {
    vec4 average = push.history > 0.0 ? imageLoad(mean_even, texel) : vec4(0.0);
    // A texel whose instance was absent has none, whatever its tile has.
    float history = average.w > 0.0 ? push.history : 0.0;
    vec4 visit = vec4(0.0);
    vec3 unlinked = vec3(0.0);
    for (uint i = 0u; i < push.quantum_count; ++i) {
        Evidence told = NOTHING;
        vec3 quantum_mean = gather(r, push.first_quantum + i, told, unlinked);
        if (push.first_quantum + i == push.evidence_quantum) evidence = told;
        // What is no number would stay in the average for good.
        if (any(isnan(quantum_mean)) || any(isinf(quantum_mean))) quantum_mean = average.rgb;
        average.rgb += (quantum_mean - average.rgb) / (history + float(i + 1u));
        accumulate(visit, quantum_mean, 1.0);
    }
    imageStore(mean_even, texel, vec4(average.rgb, history + visit.w));
    imageStore(mean_odd, texel, visit);
    return average.rgb;
}

void main() {
    uvec2 texel;
    if (!texel_of_invocation(texel)) return;
    uint place = push.first_texel + index_of_invocation();
    if (!DYNAMIC && (activity[place / gl_WorkGroupSize.x] >> field_of_invocation() & 1u) == 0u) return;
    uvec4 g = imageLoad(surface_image, ivec2(texel));
    if (DYNAMIC && (instances[g.x - 1u].flags & INSTANCE_ABSENT) != 0u) return;
    Receiver r;
    r.surface = surface_of(texel, g);
    r.sides = unpack_footprint(imageLoad(footprint_image, ivec2(texel)).x);
    r.frame = frame_of(r.surface.normal);
    r.key = texel.x | texel.y << 16u;
    r.place = place;
    bool mixed = IMPORTANCE && push.source_rays + push.sky_rays > 0u;
    r.row = mixed && CLUSTERS ? row_of(texel) : 0u;
    r.source_total = mixed && !CLUSTERS ? pyramid_total(importance_map, push.map_size) : 0.0;
    r.sky_total = mixed && SKY_MAP ? pyramid_total(sky_importance_map, uvec2(textureSize(sky_map, 0))) : 0.0;
    Evidence evidence = NOTHING;
    vec3 irradiance = DYNAMIC ? gather_average(r, ivec2(texel), evidence) : gather_halves(r, ivec2(texel), evidence);
    // One quantum tells, whichever others this dispatch has: the work may be cut in any way.
    bool tells = push.evidence_quantum - push.first_quantum < push.quantum_count;
    if (mixed && tells) store_evidence(ivec2(texel), evidence, irradiance);
}
