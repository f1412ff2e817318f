#include "core/topology/event_pages.h"

#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "core/grid/scalar_key.h"
#include "core/index/format/byte_planes.h"
#include "core/index/format/zigzag.h"
#include "core/topology/event_coder.h"

namespace isoslider::topology {
namespace {

constexpr std::size_t kWideColumns = 3, kNarrowColumns = 9;
constexpr int kPlanes = 8 * kWideColumns + 4 * kNarrowColumns;
constexpr unsigned kPlaceBits = 21; // half grid steps along an axis

// What an event changes of each count, as unsigned numbers that are small: one for each narrow column but the last.
std::array<std::int64_t, 4> changesOf(const TopologyEvent& event) {
    return {event.above.components - event.below.components, event.above.euler - event.below.euler,
            event.above.loops - event.below.loops, event.above.voids - event.below.voids};
}

std::int32_t changeOf(std::uint32_t code) { return static_cast<std::int32_t>(index::unzigzag(code)); }

struct Columns {
    std::array<std::vector<std::uint64_t>, kWideColumns> wide; ///< isovalue's key from the last one, persistence, place
    std::array<std::vector<std::uint32_t>, kNarrowColumns> narrow; ///< four changes, four of pieces, kind
};

std::vector<std::byte> encodePage(const std::vector<TopologyEvent>& events) {
    Columns columns;
    std::uint64_t last = 0;
    for (const TopologyEvent& event : events) {
        const std::uint64_t key = keyOf(event.isovalue);
        columns.wide[0].push_back(key - last);
        last = key;
        columns.wide[1].push_back(std::bit_cast<std::uint64_t>(event.persistence));
        std::uint64_t place = 0;
        for (unsigned a = 0; a < 3; ++a)
            place |= static_cast<std::uint64_t>(std::llround(2.0 * static_cast<double>(event.position[a])))
                     << (kPlaceBits * a);
        columns.wide[2].push_back(place);
        const auto changes = changesOf(event);
        for (std::size_t c = 0; c < changes.size(); ++c)
            columns.narrow[c].push_back(index::zigzag(static_cast<std::uint32_t>(changes[c])));
        columns.narrow[4].push_back(event.pieces.births);
        columns.narrow[5].push_back(event.pieces.deaths);
        columns.narrow[6].push_back(event.pieces.joins);
        columns.narrow[7].push_back(event.pieces.splits);
        columns.narrow[8].push_back(static_cast<std::uint32_t>(event.kind));
    }
    std::vector<std::byte> page;
    index::PlaneWriter planes(page, kPlanes);
    for (const auto& column : columns.wide)
        planes.addColumn(column, 8);
    for (const auto& column : columns.narrow)
        planes.addColumn(column, 4);
    return page;
}

} // namespace

Result<std::vector<TopologyEvent>> decodeEvents(const EventPage& page, std::span<const std::byte> bytes,
                                                const std::string& path) {
    index::PlaneReader planes(bytes, path, page.offset);
    ISO_TRY(planes.beginPlanes(0, kPlanes));
    Columns columns;
    for (auto& column : columns.wide)
        ISO_TRY(planes.readColumn(column, page.events, 8));
    for (auto& column : columns.narrow)
        ISO_TRY(planes.readColumn(column, page.events, 4));
    std::vector<TopologyEvent> events(page.events);
    std::uint64_t key = 0;
    SurfaceCounts counts = page.before;
    for (std::size_t i = 0; i < events.size(); ++i) {
        TopologyEvent& event = events[i];
        const std::uint64_t before = key;
        key += columns.wide[0][i];
        event.isovalue = sampleOfKey<double>(key);
        event.persistence = std::bit_cast<double>(columns.wide[1][i]);
        if (!std::isfinite(event.isovalue) || (i > 0 && key <= before) || !(event.persistence >= 0.0) ||
            !std::isfinite(event.persistence))
            return planes.corrupt("events do not ascend");
        for (unsigned a = 0; a < 3; ++a)
            event.position[a] =
                0.5f * static_cast<float>(columns.wide[2][i] >> (kPlaceBits * a) & ((1u << kPlaceBits) - 1));
        if (columns.narrow[8][i] > static_cast<std::uint32_t>(EventKind::BodySaddle))
            return planes.corrupt("kind of an event");
        event.kind = static_cast<EventKind>(columns.narrow[8][i]);
        event.pieces = {columns.narrow[4][i], columns.narrow[5][i], columns.narrow[6][i], columns.narrow[7][i]};
        event.below = counts;
        counts.components += changeOf(columns.narrow[0][i]);
        counts.euler += changeOf(columns.narrow[1][i]);
        counts.loops += changeOf(columns.narrow[2][i]);
        counts.voids += changeOf(columns.narrow[3][i]);
        event.above = counts;
    }
    return events;
}

Result<std::vector<std::byte>> EventPages::bytesOf(std::size_t page) const {
    const Bytes& coded = bytes[page];
    if (!coded.held.empty())
        return coded.held;
    std::vector<std::byte> found(pages[page].bytes);
    ISO_TRY(scratch->readAt(coded.offset, found));
    return found;
}

EventCoder::~EventCoder() {
    coding_.cancel(); // nobody wants what is not done
    try {
        coding_.wait();
    } catch (...) {} // its error, if any, is on its way already
}

void EventCoder::add(const TopologyEvent& event) {
    events_.push_back(event);
    if (events_.size() == EventPage::kMostEvents)
        endPage();
}

Result<EventPages> EventCoder::take() {
    endPage();
    coding_.wait();
    EventPages found{std::exchange(pages_, {}), {}, {}};
    std::deque<Coded> coded = std::exchange(coded_, {});
    heldBytes_ = 0;
    std::uint64_t offset = 0;
    for (std::size_t i = 0; i < coded.size(); ++i) {
        ISO_TRY(coded[i].status);
        found.pages[i].offset = offset;
        found.pages[i].bytes = coded[i].size;
        offset += coded[i].size;
        if (coded[i].bytes.held.empty())
            found.scratch = scratch_;
        found.bytes.push_back(std::move(coded[i].bytes));
    }
    return found;
}

void EventCoder::code(const std::vector<TopologyEvent>& events, Coded& to) {
    std::vector<std::byte> bytes = encodePage(events);
    to.size = static_cast<std::uint32_t>(bytes.size());
    if (!scratch_ || heldBytes_.fetch_add(bytes.size()) <= mostHeldBytes_) {
        bytes.shrink_to_fit();
        to.bytes.held = std::move(bytes);
        return;
    }
    auto offset = scratch_->append(bytes);
    if (offset.isOk())
        to.bytes.offset = offset.value();
    else
        to.status = std::move(offset).error();
}

void EventCoder::endPage() {
    if (events_.empty())
        return;
    EventPage page;
    page.firstIsovalue = events_.front().isovalue;
    page.before = events_.front().below;
    page.events = static_cast<std::uint32_t>(events_.size());
    pages_.push_back(page);
    Coded& coded = coded_.emplace_back();
    if (waiting_ >= kMostWaiting) {
        code(events_, coded);
    } else {
        ++waiting_;
        coding_.run([this, &coded, events = std::move(events_)] {
            code(events, coded);
            --waiting_;
        });
    }
    events_.clear();
}

} // namespace isoslider::topology
