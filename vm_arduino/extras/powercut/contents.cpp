#include "contents.h"

#include <stdio.h>
#include <stdlib.h>

#include "../../src/vm/crc32.h"
#include "../../src/store/layout.h"
#include "../../src/vm/image.h"

namespace tiniscript {

namespace {

uint32_t state = 1;

void put(Content* content, size_t offset, uint32_t check) {
  for (size_t k = 0; k < kCheckBytes; k++)
    (*content)[offset + k] = static_cast<uint8_t>(check >> 8 * k);
}

uint8_t any_byte() { return static_cast<uint8_t>(random_below(0x100)); }

}  // namespace

void seed_random(uint32_t seed) { state = seed * 2654435761U | 1; }

uint32_t random_below(uint32_t end) {
  state ^= state << 13;
  state ^= state >> 17;
  state ^= state << 5;
  return static_cast<uint32_t>(static_cast<uint64_t>(state) * end >> 32);
}

Content with_checksum(Content image) {
  const uint32_t head = crc32(0, image.data(), kChecksumAt);
  const uint16_t length = static_cast<uint16_t>(image.size() - kAfterChecksum);
  put(&image, kChecksumAt, crc32(head, image.data() + kAfterChecksum, length));
  return image;
}

Content random_image(uint16_t code_bytes) {
  Content image = {'T', 'S', kIsaMajor, kIsaMinor, 0, kHeaderBytes, 0x1b, 0x23};
  image.push_back(static_cast<uint8_t>(code_bytes));
  image.push_back(static_cast<uint8_t>(code_bytes >> 8));
  image.resize(kHeaderBytes);
  for (uint16_t k = 0; k < code_bytes; k++) image.push_back(any_byte());
  return with_checksum(image);
}

Content random_record(Area area) {
  Content record(area == Area::kOwner ? kOwnerBytes : kRecordBytes);
  for (uint8_t& byte : record) byte = any_byte();
  const uint16_t length = static_cast<uint16_t>(record.size() - kCheckBytes);
  put(&record, 0, crc32(0, record.data() + kCheckBytes, length));
  return record;
}

bool begin(Store* store, Area area, Content* content) {
  if (area == Area::kProgram) return store->begin_save(content->data());
  return store->begin_save_record(area, content->data());
}

Content read(const Store& store, Area area) {
  Content content;
  if (store.current_slot(area) == kNoSlot) return content;
  size_t length = area == Area::kOwner ? kOwnerBytes : kRecordBytes;
  if (area == Area::kProgram) length = kHeaderBytes;
  content.reserve(kHeaderBytes);
  while (content.size() < length) {
    uint8_t byte;
    if (!store.fetch(area, static_cast<uint16_t>(content.size()), &byte)) {
      printf("MISUSE what counts cannot be read\n");
      exit(3);
    }
    content.push_back(byte);
    if (area == Area::kProgram && content.size() == kHeaderBytes) {
      length = content[kHeaderLengthAt] + content[kCodeLengthAt] + content[kCodeLengthAt + 1] * 256U;
      if (length < kMemoryBytes) content.reserve(length);
    }
  }
  return content;
}

}  // namespace tiniscript
