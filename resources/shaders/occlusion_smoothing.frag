#version 330 core
// Takes the pattern of 4 pixels away, along one side, among what lies at about the same distance.
uniform sampler2D distances;
uniform sampler2D openness;
uniform vec2 halfPixels;
uniform vec2 along;

out float smoothed;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy), last = ivec2(halfPixels) - 1;
    float here = texelFetch(distances, pixel, 0).r;
    float sum = 0.0, weights = 0.0;
    for (int step = -2; step < 2; ++step) {
        ivec2 other = clamp(pixel + step * ivec2(along), ivec2(0), last);
        float weight = max(1.0 - 4.0 * abs(texelFetch(distances, other, 0).r - here), 1e-3);
        sum += weight * texelFetch(openness, other, 0).r;
        weights += weight;
    }
    smoothed = sum / weights;
}
