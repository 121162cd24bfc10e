// Analytic lights: KHR_lights_punctual.
#ifndef LIGHTS_GLSL
#define LIGHTS_GLSL

layout(set = 0, binding = 6, std430) readonly buffer Lights { Light lights[]; };

// Irradiance that a light gives a surface without anything between, and the way and distance to it.
struct Incident {
    vec3 irradiance;
    vec3 direction;  // toward the light
    float distance;
};

Incident incident_of(Light light, vec3 point, vec3 normal) {
    Incident incident;
    if (light.kind == LIGHT_DIRECTIONAL) {
        incident.direction = -light.direction;
        incident.distance = 1e30;
        incident.irradiance = light.intensity * max(0.0, dot(normal, incident.direction));
        return incident;
    }
    vec3 toward = light.position - point;
    incident.distance = length(toward);
    incident.direction = toward / max(incident.distance, 1e-30);
    float share = max(0.0, dot(normal, incident.direction));
    if (light.kind == LIGHT_SPOT) {
        float cone = clamp(dot(light.direction, -incident.direction) * light.cone_scale + light.cone_offset, 0.0, 1.0);
        share *= cone * cone;
    }
    if (light.range > 0.0) {
        float ratio = incident.distance / light.range;
        share *= clamp(1.0 - ratio * ratio * ratio * ratio, 0.0, 1.0);
    }
    // Divided twice: a squared distance leaves fp32 sooner than the distance does.
    incident.irradiance = light.intensity * (share / incident.distance / incident.distance);
    // A light that lies on a surface has no finite answer there.
    if (any(isnan(incident.irradiance)) || any(isinf(incident.irradiance))) incident.irradiance = vec3(0.0);
    return incident;
}

#endif
