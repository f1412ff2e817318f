#pragma once

#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace isoslider::bench {

/// A hash table with chains (PAPER 3.2): h(x) = ((a x + b) mod p) mod n from a strongly 2-universal
/// family, p the prime 2^61 - 1, a and b drawn once. n is fixed. Nodes lie in one array; freed ones are
/// used again. REQUIRES of keys: below p.
template <class Value>
class ChainedTable {
public:
    explicit ChainedTable(std::uint64_t size, std::uint64_t seed) : heads_(size > 0 ? size : 1, kNone) {
        std::mt19937_64 random(seed);
        a_ = 1 + random() % (kPrime - 1);
        b_ = random() % kPrime;
    }

    /// Null where there is no such key. Pointers are valid until the next insertion.
    Value* find(std::uint64_t key) {
        for (std::uint32_t at = heads_[bucketOf(key)]; at != kNone; at = nodes_[at].next)
            if (nodes_[at].key == key)
                return &nodes_[at].value;
        return nullptr;
    }
    /// REQUIRES: the key is not there.
    Value& insert(std::uint64_t key, const Value& value) {
        std::uint32_t at = free_;
        if (at != kNone) {
            free_ = nodes_[at].next;
        } else {
            at = static_cast<std::uint32_t>(nodes_.size());
            nodes_.emplace_back();
        }
        std::uint32_t& head = heads_[bucketOf(key)];
        nodes_[at] = {key, value, head};
        head = at;
        return nodes_[at].value;
    }
    Value& findOrInsert(std::uint64_t key) {
        Value* found = find(key);
        return found ? *found : insert(key, Value{});
    }
    void erase(std::uint64_t key) {
        std::uint32_t* link = &heads_[bucketOf(key)];
        while (*link != kNone && nodes_[*link].key != key)
            link = &nodes_[*link].next;
        if (*link == kNone)
            return;
        const std::uint32_t at = *link;
        *link = nodes_[at].next;
        nodes_[at].next = free_;
        free_ = at;
    }
    std::uint64_t memoryBytes() const {
        return heads_.capacity() * sizeof(std::uint32_t) + nodes_.capacity() * sizeof(Node);
    }

private:
    static constexpr std::uint64_t kPrime = (std::uint64_t{1} << 61) - 1;
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    struct Node {
        std::uint64_t key = 0;
        Value value{};
        std::uint32_t next = kNone;
    };

    std::uint64_t bucketOf(std::uint64_t key) const {
        const unsigned __int128 product = static_cast<unsigned __int128>(a_) * key + b_;
        // 2^61 = 1 mod p: the digits to base 2^61 are added.
        std::uint64_t rest = static_cast<std::uint64_t>(product & kPrime) + static_cast<std::uint64_t>(product >> 61);
        if (rest >= kPrime)
            rest -= kPrime;
        return rest % heads_.size();
    }

    std::uint64_t a_ = 1, b_ = 0;
    std::vector<std::uint32_t> heads_;
    std::vector<Node> nodes_;
    std::uint32_t free_ = kNone;
};

} // namespace isoslider::bench
