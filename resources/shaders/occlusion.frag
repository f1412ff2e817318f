#version 330 core
// How much of the light from all sides reaches what a pixel shows. Lengths are in radii.
uniform sampler2D distances;
uniform vec2 pixels;
uniform vec2 halfPixels;
uniform vec2 halfView;     // at distance 1 in perspective
uniform float perspective; // 1 perspective, 0 orthographic
uniform float radius;

out float openness;

const int kProbes = 12;
const float kTurns = 7.0; // of the spiral on which they lie; no common divisor with their number
const float kBias = 0.06; // the sine of a rise that is none: planes seen at a flat angle are not quite plane
const float kStrength = 3.5;
const float kNothing = 1e5;
const float kMostPixels = 90.0;

vec3 placeAt(ivec2 pixel) {
    float ahead = texelFetch(distances, clamp(pixel, ivec2(0), ivec2(halfPixels) - 1), 0).r;
    vec2 place = (2.0 * vec2(pixel) + 0.5) / pixels * 2.0 - 1.0;
    // halfView is in lengths where it grows with the distance, which is in radii: both make radii
    return vec3(place * halfView * (perspective > 0.5 ? ahead : 1.0), -ahead);
}

// Across the nearer of the neighbours: the other one may lie on something else.
vec3 nearer(vec3 before, vec3 here, vec3 after) {
    vec3 a = here - before, b = after - here;
    return abs(a.z) < abs(b.z) ? a : b;
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 here = placeAt(pixel);
    openness = 1.0;
    if (-here.z > kNothing)
        return;
    vec3 right = nearer(placeAt(pixel - ivec2(1, 0)), here, placeAt(pixel + ivec2(1, 0)));
    vec3 up = nearer(placeAt(pixel - ivec2(0, 1)), here, placeAt(pixel + ivec2(0, 1)));
    vec3 normal = normalize(cross(right, up));
    float reach = 0.5 * halfPixels.y / (halfView.y * (perspective > 0.5 ? -here.z : 1.0)); // of a radius, in pixels
    reach = clamp(reach, 1.0, kMostPixels);
    // Every 4 by 4 pixels have all 16 turns of the spiral.
    int turn = (pixel.x & 3) + 4 * (pixel.y & 3);
    float start = 6.2831853 * float((turn * 7) & 15) / 16.0;
    float hidden = 0.0;
    for (int probe = 0; probe < kProbes; ++probe) {
        float out01 = (float(probe) + 0.5) / float(kProbes);
        float angle = 6.2831853 * kTurns * out01 + start;
        vec3 way = placeAt(pixel + ivec2(round(out01 * reach * vec2(cos(angle), sin(angle))))) - here;
        float square = dot(way, way);
        float rise = dot(way, normal) * inversesqrt(square + 1e-12);
        hidden += max(1.0 - square, 0.0) * max(rise - kBias, 0.0);
    }
    openness = max(0.0, 1.0 - kStrength * hidden / float(kProbes));
}
