#version 330 core
uniform vec4 lineColour;

#ifdef PEELING // see ui/render/transparent_layers.h
uniform sampler2D opaqueDepth;
uniform sampler2D peeledDepth; // of the layer before
#endif

out vec4 colour;

void main() {
    colour = lineColour;
#ifdef PEELING
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = gl_FragCoord.z;
    if (depth <= texelFetch(peeledDepth, pixel, 0).r || depth >= texelFetch(opaqueDepth, pixel, 0).r)
        discard;
    gl_FragDepth = depth;
    colour = vec4(lineColour.rgb * lineColour.a, lineColour.a);
#endif
}
