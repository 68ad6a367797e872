"""Priority queue of a compiled search: a binary heap in arrays; outdated entries may stay."""

from typing import Any

from push_dynamics.compiled import compiled


@compiled
def push(keys: Any, items: Any, count: int, key: float, item: int) -> int:
    """
    Add an item.

    :param keys: of the heap, shape (n,).
    :param items: of the heap, shape (n,).
    :param count: number of items in it, below n.
    :param key: of the item; the least comes first.
    :param item: number of the item.
    :return: the new count.
    """
    i = count
    while i > 0:
        parent = (i - 1) >> 1
        if keys[parent] <= key:
            break
        keys[i], items[i] = keys[parent], items[parent]
        i = parent
    keys[i], items[i] = key, item
    return count + 1


@compiled
def remove_first(keys: Any, items: Any, count: int) -> int:
    """
    Remove the item with the least key, ``items[0]``.

    :param keys: of the heap.
    :param items: of the heap.
    :param count: number of items in it, at least 1.
    :return: the new count.
    """
    count -= 1
    key, item = keys[count], items[count]
    i = 0
    while True:
        child = 2 * i + 1
        if child >= count:
            break
        if child + 1 < count and keys[child + 1] < keys[child]:
            child += 1
        if keys[child] >= key:
            break
        keys[i], items[i] = keys[child], items[child]
        i = child
    keys[i], items[i] = key, item
    return count
