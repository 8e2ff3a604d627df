// Searches a linked list in scattered order, then reverses it: loads that depend on loads.
#include <stddef.h>

#include "bench.h"

enum { nodes = 256, rounds = 3200 };

struct node {
  struct node* next;
  uint16_t key, value;
};

static struct node pool[nodes];

static struct node* reversed(struct node* list) {
  struct node* done = NULL;
  while (list != NULL) {
    struct node* rest = list->next;
    list->next = done;
    done = list;
    list = rest;
  }
  return done;
}

static const struct node* find(const struct node* list, uint16_t key) {
  while (list != NULL && list->key != key) list = list->next;
  return list;
}

int main(void) {
  uint32_t seed = 1, sum = 0;
  struct node* list = NULL;
  for (uint32_t i = 0; i < nodes; ++i) {
    struct node* n = &pool[i * 157 % nodes];  // 157 and 256 share no factor
    n->key = (uint16_t)i;
    n->value = (uint16_t)next_random(&seed);
    n->next = list;
    list = n;
  }
  for (uint32_t round = 0; round < rounds; ++round) {
    for (uint32_t k = 0; k < 300; ++k) {
      const struct node* n = find(list, (uint16_t)(next_random(&seed) % 300));
      sum = sum * 31 + (n != NULL ? n->value : k);
    }
    list = reversed(list);
  }
  return report("list_search", sum);
}
