#include "ui/render/transparent_layers.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

namespace isoslider::render {
namespace {

constexpr float kLeastShare = 1.0f / 256.0f;

} // namespace

int TransparentLayers::layersFor(float leastOpacity, bool isDraft) {
    const int most = isDraft ? kMostDraftLayers : kMostLayers;
    const float through = 1.0f - leastOpacity;
    if (through <= kLeastShare)
        return 1;
    const float enough = std::ceil(std::log(kLeastShare) / std::log(through));
    return enough < static_cast<float>(most) ? static_cast<int>(enough) : most;
}

TransparentLayers::~TransparentLayers() {
    if (emptyArray_ == 0)
        return;
    for (Target* target : {&blended_, &layers_[0], &layers_[1]})
        free(*target);
    gl_.glDeleteQueries(1, &query_);
    gl_.glDeleteVertexArrays(1, &emptyArray_);
}

void TransparentLayers::abandon() {
    emptyArray_ = 0;
    composing_.reset();
    opaque_.abandon();
}

void TransparentLayers::free(Target& target) {
    gl_.glDeleteFramebuffers(1, &target.framebuffer);
    gl_.glDeleteTextures(1, &target.colour);
    gl_.glDeleteTextures(1, &target.depth);
    target = {};
}

bool TransparentLayers::allocate(Target& target, GLenum colour, GLenum depth) {
    free(target);
    gl_.glGenFramebuffers(1, &target.framebuffer);
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
    const auto attach = [&](GLuint& texture, GLenum format, GLenum given, GLenum type, GLenum place) {
        gl_.glGenTextures(1, &texture);
        gl_.glBindTexture(GL_TEXTURE_2D, texture);
        gl_.glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), room_.x, room_.y, 0, given, type, nullptr);
        gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        gl_.glFramebufferTexture2D(GL_FRAMEBUFFER, place, GL_TEXTURE_2D, texture, 0);
    };
    attach(target.colour, colour, GL_RGBA, GL_FLOAT, GL_COLOR_ATTACHMENT0);
    if (depth != 0)
        attach(target.depth, depth, GL_DEPTH_COMPONENT, GL_FLOAT, GL_DEPTH_ATTACHMENT);
    gl_.glBindTexture(GL_TEXTURE_2D, 0);
    const GLenum drawn = GL_COLOR_ATTACHMENT0;
    gl_.glDrawBuffers(1, &drawn);
    gl_.glReadBuffer(drawn);
    return gl_.glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

// Drafts have fewer pixels: they are drawn into a part of what there is.
bool TransparentLayers::prepare(glm::ivec2 pixels) {
    if (emptyArray_ == 0) {
        gl_.glGenVertexArrays(1, &emptyArray_);
        gl_.glGenQueries(1, &query_);
        composing_ = loadProgram("background", "layer");
    }
    if (composing_ == nullptr || glm::max(room_, pixels) == room_)
        return composing_ != nullptr && !isBroken_;
    room_ = glm::max(room_, pixels);
    // Depths of layers are compared with those of the next one: they must not be rounded.
    isBroken_ = !allocate(blended_, GL_RGBA16F, 0) || !allocate(layers_[0], GL_RGBA16F, GL_DEPTH_COMPONENT32F) ||
                !allocate(layers_[1], GL_RGBA16F, GL_DEPTH_COMPONENT32F);
    return !isBroken_;
}

void TransparentLayers::bind(const Target& target) { gl_.glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer); }

bool TransparentLayers::drawLayer(const Target& layer, const Target& before, const std::function<bool()>& drawAll) {
    bind(layer);
    gl_.glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    gl_.glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    for (const auto& [unit, texture] :
         {std::pair(kOpaqueUnit, opaque_.texture()), std::pair(kPeeledUnit, before.depth)}) {
        gl_.glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
        gl_.glBindTexture(GL_TEXTURE_2D, texture);
    }
    gl_.glActiveTexture(GL_TEXTURE0);
    gl_.glEnable(GL_DEPTH_TEST);
    gl_.glDepthFunc(GL_LESS);
    gl_.glDisable(GL_BLEND);
    gl_.glBeginQuery(GL_ANY_SAMPLES_PASSED, query_);
    const bool isWhole = drawAll();
    gl_.glEndQuery(GL_ANY_SAMPLES_PASSED);
    return isWhole;
}

void TransparentLayers::compose(GLuint texture) {
    gl_.glDisable(GL_DEPTH_TEST);
    gl_.glEnable(GL_BLEND);
    composing_->bind();
    composing_->setUniformValue("layer", 0);
    gl_.glActiveTexture(GL_TEXTURE0);
    gl_.glBindTexture(GL_TEXTURE_2D, texture);
    gl_.glBindVertexArray(emptyArray_);
    gl_.glDrawArrays(GL_TRIANGLES, 0, 3);
    gl_.glBindVertexArray(0);
    gl_.glBindTexture(GL_TEXTURE_2D, 0);
    composing_->release();
    gl_.glDisable(GL_BLEND);
}

bool TransparentLayers::draw(glm::ivec2 pixels, int layers, const std::function<bool()>& drawAll) {
    GLint bound = 0;
    gl_.glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    const auto picture = static_cast<GLuint>(bound);
    bool isWhole = true;
    const bool isPrepared = prepare(pixels) && opaque_.copy(picture, pixels);
    if (isPrepared) {
        bind(blended_);
        gl_.glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
        gl_.glClear(GL_COLOR_BUFFER_BIT);
        bind(layers_[1]); // before the first layer nothing is
        gl_.glClearDepth(0.0);
        gl_.glClear(GL_DEPTH_BUFFER_BIT);
        gl_.glClearDepth(1.0);
        for (int layer = 0; layer < layers && isWhole; ++layer) {
            isWhole = drawLayer(layers_[static_cast<std::size_t>(layer % 2)],
                                layers_[static_cast<std::size_t>((layer + 1) % 2)], drawAll);
            GLuint hasAny = GL_FALSE;
            gl_.glGetQueryObjectuiv(query_, GL_QUERY_RESULT, &hasAny);
            if (hasAny == GL_FALSE)
                break;
            bind(blended_);
            gl_.glBlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE); // behind what is there
            compose(layers_[static_cast<std::size_t>(layer % 2)].colour);
        }
    }
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, picture);
    if (isWhole && isPrepared) {
        // Alpha stays 1, as for the box.
        gl_.glBlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
        compose(blended_.colour);
    }
    for (const int unit : {kPeeledUnit, kOpaqueUnit}) {
        gl_.glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
        gl_.glBindTexture(GL_TEXTURE_2D, 0);
    }
    gl_.glActiveTexture(GL_TEXTURE0);
    gl_.glEnable(GL_DEPTH_TEST);
    gl_.glDepthFunc(GL_LEQUAL);
    return isWhole;
}

} // namespace isoslider::render
