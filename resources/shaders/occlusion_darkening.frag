#version 330 core
// What a pixel is multiplied with: of the four around it at half the resolution, those that lie at about its distance.
uniform sampler2D depths;
uniform sampler2D distances;
uniform sampler2D openness;
uniform vec2 halfPixels;
uniform vec2 depthRow;
uniform float perspective;
uniform float radius;

out vec4 colour;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy), last = ivec2(halfPixels) - 1;
    float depth = texelFetch(depths, pixel, 0).r;
    if (depth >= 1.0)
        discard;
    float clip = 2.0 * depth - 1.0;
    float here = (perspective > 0.5 ? depthRow.y / (clip + depthRow.x) : (depthRow.y - clip) / depthRow.x) / radius;
    ivec2 first = pixel / 2;
    vec2 part = 0.5 * vec2(pixel & 1);
    float sum = 0.0, weights = 0.0;
    for (int corner = 0; corner < 4; ++corner) {
        ivec2 side = ivec2(corner & 1, corner >> 1);
        ivec2 other = min(first + side, last);
        vec2 shares = mix(1.0 - part, part, vec2(side));
        float weight = shares.x * shares.y * max(1.0 - 4.0 * abs(texelFetch(distances, other, 0).r - here), 1e-3);
        sum += weight * texelFetch(openness, other, 0).r;
        weights += weight;
    }
    // As seen: colours are no longer linear light.
    colour = vec4(vec3(pow(sum / weights, 1.0 / 2.2)), 1.0);
}
