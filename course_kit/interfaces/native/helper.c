/* The C half of the live interfaces: what Fast DDS and rclpy call for a message type made at run time.
 *
 * Fast DDS holds a mutex while it has a message serialised, so nothing here that it calls may wait for Python:
 * a Python thread that holds the interpreter may be waiting for that very mutex. What runs outside those locks
 * (the conversion from and to Python objects) calls back into Python.
 *
 * A live message is its own CDR payload together with a pointer to its type. So every function below learns from
 * the message itself what it needs to know, whichever endpoint hands it over; only the functions that make a
 * message from nothing need one copy for each type. Those are compiled in advance, SLOTS of them; when all are in
 * use, Python loads another copy of this library.
 *
 * No header of Python or ROS is needed; the layouts are those of ROS 2 Jazzy's rosidl_runtime_c and
 * rosidl_typesupport_fastrtps_c. The memory of type supports is never freed: DDS may read it until the process ends.
 */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---------------------------------------------------------------- what the rest of the process provides */

struct py_buffer {                               /* Py_buffer, of which only the beginning is looked at */
  void *data, *owner;
  ptrdiff_t size;
  void *rest[16];
};

struct imports {
  char *(*cdr_position)(void *cdr);              /* eprosima::fastcdr::Cdr::get_current_position() */
  bool (*cdr_jump)(void *cdr, size_t bytes);     /* eprosima::fastcdr::Cdr::jump(): false when there is no room */
  size_t buffer_in_cdr;                          /* where Cdr keeps its FastBuffer& */
  size_t data_in_buffer, size_in_buffer;         /* where FastBuffer keeps its memory and its length */
  void (*set_error)(const char *text, const char *file, size_t line); /* rcutils_set_error_state */
  void *none;                                    /* the object None */
  void *release;                                 /* the name of a method */
  void *list, *bytes, *yes, *no;                 /* the classes, and the two objects */
  size_t items_in_list, data_in_bytes;           /* where a list has its items, and bytes have theirs; 0: not known */
  void *(*call)(void *function, ...);            /* PyObject_CallFunctionObjArgs */
  void *(*bytes_new)(const char *, ptrdiff_t);   /* PyBytes_FromStringAndSize */
  void *(*view_new)(const char *, ptrdiff_t, int flags); /* PyMemoryView_FromMemory */
  void *(*call_method)(void *object, void *name, ...);   /* PyObject_CallMethodObjArgs */
  int (*buffer_get)(void *, struct py_buffer *, int flags); /* PyObject_GetBuffer */
  void (*buffer_release)(struct py_buffer *);    /* PyBuffer_Release */
  int (*is_buffer)(void *);                      /* PyObject_CheckBuffer */
  ptrdiff_t (*tuple_size)(void *);               /* PyTuple_Size */
  void *(*tuple_item)(void *, ptrdiff_t);        /* PyTuple_GetItem */
  char *(*bytes_data)(void *);                   /* PyBytes_AsString */
  void (*incref)(void *);                        /* Py_IncRef */
  void (*decref)(void *);                        /* Py_DecRef */
  void *(*no_memory)(void);                      /* PyErr_NoMemory */
  void (*error_fetch)(void **, void **, void **);/* PyErr_Fetch */
  void (*error_restore)(void *, void *, void *); /* PyErr_Restore */
  void (*unraisable)(void *);                    /* PyErr_WriteUnraisable */
  int (*gil_ensure)(void);                       /* PyGILState_Ensure */
  void (*gil_release)(int);                      /* PyGILState_Release */
};

static struct imports host;

void live_setup(const struct imports *imports) { host = *imports; }

/* Which helper.c this was compiled from, so that Python can refuse a library that is older or newer than itself. */
uint32_t live_source(void) { return SOURCE_CRC; }

/* ---------------------------------------------------------------- messages */

struct live_type {
  const char *name;                              /* such as my_interfaces/srv/PersonInfo_Request */
  bool complained;                               /* about a message that does not fit */
  const uint32_t *program;                       /* how to walk a payload, see enum step */
  size_t program_length;
  void *encode, *decode;                         /* Python: message -> bytes, bytes -> message */
  void *make_event;                              /* Python, event messages only: (info, request, response) -> bytes */
};

struct live_message {
  char *data;                                    /* CDR payload with its 4-byte encapsulation header */
  size_t size, capacity;
  struct live_type *type;
};

enum { HEADER = 4, PADDING = 3 };

static struct live_message *new_message(struct live_type *type)
{
  struct live_message *message = calloc(1, sizeof *message);
  if (message) message->type = type;
  return message;
}

void live_destroy(struct live_message *message)
{
  if (!message) return;
  free(message->data);
  free(message);
}

static bool reserve(struct live_message *message, size_t size)
{
  if (size > message->capacity) {
    char *grown = realloc(message->data, size);
    if (!grown) return false;
    message->data = grown;
    message->capacity = size;
  }
  message->size = size;
  return true;
}

static bool assign(struct live_message *message, const char *data, size_t size)
{
  if (!reserve(message, size)) return false;
  memcpy(message->data, data, size);
  return true;
}

/* ---------------------------------------------------------------- is a payload what the type says? */

/* A malformed payload has to fail in live_deserialize, where it is dropped as with a compiled type; rclpy gives
 * up a subscription whose messages cannot be converted to Python.
 */
enum step {
  RUN = 1,       /* align, size, count     that many values of a fixed size */
  STRING,        /*                        length in bytes, bytes */
  WSTRING,       /*                        length in units, 4 bytes each */
  VALUES,        /* size, bound            sequence of values; a bound of 0 is none */
  REPEAT,        /* count, length, ...     array: the next `length` words, `count` times */
  REPEAT_LIST    /* bound, length, ...     sequence: the same, as often as the payload says */
};

struct walk {
  const unsigned char *payload;
  size_t at, end, max_align;
  size_t estimate;                               /* where rmw_serialize would expect to be, see live_valid */
  bool swap;                                     /* the payload is big-endian */
};

static size_t aligned(const struct walk *walk, size_t position, size_t align)
{
  if (align > walk->max_align) align = walk->max_align;
  return position + ((HEADER - position) & (align - 1));  /* alignment counts from behind the header */
}

static bool skip(struct walk *walk, size_t align, size_t bytes)
{
  size_t start = aligned(walk, walk->at, align);
  if (start > walk->end || bytes > walk->end - start) return false;
  walk->at = start + bytes;
  walk->estimate = aligned(walk, walk->estimate, align) + bytes;
  return true;
}

static uint32_t word_at(const struct walk *walk, size_t position)
{
  const unsigned char *b = walk->payload + position;
  return walk->swap ? (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3]
                    : (uint32_t)b[3] << 24 | (uint32_t)b[2] << 16 | (uint32_t)b[1] << 8 | b[0];
}

static bool read_length(struct walk *walk, size_t *length)
{
  if (!skip(walk, 4, 4)) return false;
  *length = word_at(walk, walk->at - 4);
  return true;
}

static bool read_bounded_length(struct walk *walk, size_t bound, size_t *length)
{
  return read_length(walk, length) && (!bound || *length <= bound);
}

/* UTF-16, one unit in each 4 bytes; surrogates only in pairs, or there is no Python string for it. */
static bool wide_string(struct walk *walk)
{
  size_t count;
  if (!read_length(walk, &count) || !skip(walk, 1, 4 * count)) return false;
  walk->estimate += 4;
  bool in_pair = false;
  for (size_t position = walk->at - 4 * count; position < walk->at; position += 4) {
    uint32_t unit = word_at(walk, position);
    bool second = unit >= 0xDC00 && unit < 0xE000;
    if (unit > 0xFFFF || second != in_pair) return false;
    in_pair = unit >= 0xD800 && unit < 0xDC00;
  }
  return !in_pair;
}

static bool follow(struct walk *walk, const uint32_t *step, const uint32_t *end)
{
  size_t n;
  while (step < end) {
    switch (*step) {
    case RUN:
      if (!skip(walk, step[1], (size_t)step[2] * step[3])) return false;
      step += 4;
      break;
    case STRING:
      if (!read_length(walk, &n) || !skip(walk, 1, n)) return false;
      step += 1;
      break;
    case WSTRING:
      if (!wide_string(walk)) return false;
      step += 1;
      break;
    case VALUES:
      if (!read_bounded_length(walk, step[2], &n)) return false;
      if (n && !skip(walk, step[1], n * step[1])) return false;
      if (!n) walk->estimate = aligned(walk, walk->estimate, step[1]);  /* an empty sequence has no padding */
      step += 3;
      break;
    case REPEAT:
    case REPEAT_LIST:
      n = step[1];
      if (*step == REPEAT_LIST && !read_bounded_length(walk, step[1], &n)) return false;
      for (; n; n--)
        if (!follow(walk, step + 3, step + 3 + step[2])) return false;
      step += 3 + step[2];
      break;
    default:
      return false;
    }
  }
  return true;
}

/* Data behind the last field mean that the sender has another definition in mind: it may be running since before
 * the type was defined anew. Two things may follow all the same: padding to a multiple of 4, by RTPS; and what
 * rmw_serialize appends to a message it has estimated to be longer than it is, since the generated
 * get_serialized_size counts a terminator for wide strings and padding in front of empty sequences. */
bool live_valid(const struct live_type *type, const char *payload, size_t size)
{
  const unsigned char *header = (const unsigned char *)payload;
  if (size < HEADER || header[0] != 0) return false;
  unsigned encoding = header[1];                 /* 0, 1: XCDR1 big, little endian; 6, 7: XCDR2 */
  if (encoding != 0 && encoding != 1 && encoding != 6 && encoding != 7) return false;
  struct walk walk = {header, HEADER, size, encoding > 1 ? 4 : 8, HEADER, !(encoding & 1)};
  if (!follow(&walk, type->program, type->program + type->program_length)) return false;
  size_t longest = walk.estimate > walk.at ? walk.estimate : walk.at;
  return size <= longest + PADDING;
}

/* Once for each type, on stderr: a silent loss would be a riddle. Neither Python nor ROS's logging may be called
 * under the locks held here. */
static void complain(struct live_type *type)
{
  if (type->complained) return;
  type->complained = true;
  char text[512];
  int length = snprintf(text, sizeof text,
                        "[WARN] [course_kit.interfaces]: dropped a message that is not a %s as this program knows it. "
                        "Some node on the same name uses a different definition: stop or restart the older one. "
                        "(This is said once.)\n", type->name);
  if (length > 0 && write(STDERR_FILENO, text, strlen(text)) < 0) return;  /* nobody is listening */
}

/* ---------------------------------------------------------------- called by rmw_fastrtps, possibly under locks */

static bool live_serialize(const struct live_message *message, void *cdr)
{
  if (!message || message->size < HEADER) return false;
  size_t size = message->size - HEADER;          /* the caller has written the header */
  if (!host.cdr_jump(cdr, size)) return false;
  memcpy(host.cdr_position(cdr) - size, message->data + HEADER, size);
  return true;
}

static bool live_deserialize(void *cdr, struct live_message *message)
{
  const char *buffer, *payload;
  size_t size;
  memcpy(&buffer, (const char *)cdr + host.buffer_in_cdr, sizeof buffer);
  memcpy(&payload, buffer + host.data_in_buffer, sizeof payload);
  memcpy(&size, buffer + host.size_in_buffer, sizeof size);
  if (live_valid(message->type, payload, size)) return assign(message, payload, size);
  complain(message->type);
  char text[300];                                /* without it ROS would say "error not set" */
  snprintf(text, sizeof text, "the bytes are not a %s as this program knows it", message->type->name);
  host.set_error(text, "course_kit.interfaces", __LINE__);
  return false;
}

static uint32_t live_serialized_size(const struct live_message *message)
{
  return message->size < HEADER ? 0u : (uint32_t)(message->size - HEADER);
}

static size_t live_max_serialized_size(char *bounds)
{
  *bounds = 0;                                   /* unbounded: DDS asks for the size of each message */
  return 0;
}

/* ---------------------------------------------------------------- called by rclpy, with the interpreter held */

static bool assign_bytes(struct live_message *message, void *bytes)
{
  struct py_buffer buffer;
  if (host.buffer_get(bytes, &buffer, 0) != 0) return false;
  bool done = assign(message, buffer.data, (size_t)buffer.size);
  host.buffer_release(&buffer);
  if (!done) host.no_memory();
  return done;
}

static bool assign_parts(struct live_message *message, void *tuple)
{
  ptrdiff_t count = host.tuple_size(tuple), held = 0;
  if (count < 0) return false;
  struct py_buffer *parts = calloc((size_t)count + 1, sizeof *parts);
  size_t size = 0;
  while (parts && held < count && host.buffer_get(host.tuple_item(tuple, held), &parts[held], 0) == 0)
    size += (size_t)parts[held++].size;
  bool complete = parts && held == count, done = complete && reserve(message, size);
  char *end = message->data;
  for (ptrdiff_t i = 0; i < held; i++) {
    if (done) {
      memcpy(end, parts[i].data, (size_t)parts[i].size);
      end += parts[i].size;
    }
    host.buffer_release(&parts[i]);
  }
  if (!parts || (complete && !done)) host.no_memory();
  free(parts);
  return done;
}

/* What an encoder makes: bytes, or a tuple of parts where that saves copying much. */
static bool assign_payload(struct live_message *message, void *payload)
{
  return host.is_buffer(payload) ? assign_bytes(message, payload) : assign_parts(message, payload);
}

bool live_from_python(void *object, struct live_message *message)
{
  void *payload = host.call(message->type->encode, object, NULL);
  if (!payload) return false;
  bool done = assign_payload(message, payload);
  host.decref(payload);
  return done;
}

/* A large payload is not copied for Python but shown to it, and taken back before it is gone. */
enum { LARGE = 4096, READ_ONLY = 0x100 };        /* PyBUF_READ */

static void *decoded_in_place(const struct live_message *message)
{
  void *view = host.view_new(message->data, (ptrdiff_t)message->size, READ_ONLY);
  if (!view) return NULL;
  void *object = host.call(message->type->decode, view, NULL);
  void *error[3] = {NULL, NULL, NULL};
  if (!object) host.error_fetch(&error[0], &error[1], &error[2]);
  void *none = host.call_method(view, host.release, NULL);
  if (none) host.decref(none);
  if (!none && object) {
    host.decref(object);
    object = NULL;
  }
  if (error[0]) host.error_restore(error[0], error[1], error[2]);
  host.decref(view);
  return object;
}

void *live_to_python(const struct live_message *message)
{
  if (message->size >= LARGE) return decoded_in_place(message);
  void *bytes = host.bytes_new(message->data, (ptrdiff_t)message->size);
  if (!bytes) return NULL;
  void *object = host.call(message->type->decode, bytes, NULL);
  host.decref(bytes);
  return object;
}

/* ---------------------------------------------------------------- called by encoders, for lists of many elements */

/* Every Python object begins with these; the offsets that follow from it are looked at before they are used. */
struct object {
  ptrdiff_t references;
  void *class;
  ptrdiff_t size;                                /* of those that have one, such as lists and bytes */
};

static inline bool as_octet(const void *item, char *octet, const struct imports *known)
{
  const struct object *object = item;
  if (object->class != known->bytes || object->size != 1) return false;
  *octet = ((const char *)item)[known->data_in_bytes];
  return true;
}

static inline bool as_boolean(const void *item, char *octet, const struct imports *known)
{
  *octet = item == known->yes;
  return (item == known->yes) | (item == known->no);
}

/* One byte for each element of a list; None for what is no list of such elements, which is then looked at in Python. */
typedef bool as_byte_function(const void *item, char *octet, const struct imports *known);

static inline __attribute__((always_inline)) void *packed(void *values, as_byte_function *as_byte)
{
  const struct object *list = values;
  void *bytes = NULL;
  if (host.items_in_list && host.data_in_bytes && list->class == host.list) {
    bytes = host.bytes_new(NULL, list->size);
    if (!bytes) return NULL;
    void *const *items;
    memcpy(&items, (const char *)values + host.items_in_list, sizeof items);
    char *data = host.bytes_data(bytes);
    const struct imports known = host;           /* a copy: what is written to `data` cannot change it */
    const ptrdiff_t size = list->size;
    bool fit = true;
    for (ptrdiff_t i = 0; i < size; i++) fit &= as_byte(items[i], data + i, &known);
    if (!fit) {
      host.decref(bytes);
      bytes = NULL;
    }
  }
  if (bytes) return bytes;
  host.incref(host.none);
  return host.none;
}

void *live_booleans(void *values) { return packed(values, as_boolean); }

void *live_octets(void *values) { return packed(values, as_octet); }

/* ---------------------------------------------------------------- service introspection */

enum { INFO_SIZE = 40 };                         /* rosidl_service_introspection_info_t */

static void *bytes_or_none(const struct live_message *message)
{
  return message ? host.bytes_new(message->data, (ptrdiff_t)message->size) : host.none;
}

static bool fill_event(struct live_message *event, const char *info, const struct live_message *request,
                       const struct live_message *response)
{
  void *arguments[3] = {host.bytes_new(info, INFO_SIZE), bytes_or_none(request), bytes_or_none(response)};
  void *bytes = NULL;
  if (arguments[0] && arguments[1] && arguments[2])
    bytes = host.call(event->type->make_event, arguments[0], arguments[1], arguments[2], NULL);
  bool done = bytes && assign_payload(event, bytes);
  if (!done) host.unraisable(event->type->make_event);  /* rcl reports that the event could not be made */
  if (bytes) host.decref(bytes);
  for (int i = 0; i < 3; i++)
    if (arguments[i] && arguments[i] != host.none) host.decref(arguments[i]);
  return done;
}

static void *new_event(struct live_type *type, const char *info, const struct live_message *request,
                       const struct live_message *response)
{
  struct live_message *event = new_message(type);
  if (!event) return NULL;
  int gil = host.gil_ensure();
  bool done = fill_event(event, info, request, response);
  host.gil_release(gil);
  if (done) return event;
  live_destroy(event);
  return NULL;
}

static bool live_destroy_event(struct live_message *event, void *allocator)
{
  (void)allocator;
  live_destroy(event);
  return true;
}

/* ---------------------------------------------------------------- functions that exist once for each type */

enum { SLOTS = 1024 };

static struct live_type types[SLOTS];
static size_t types_used;

#define TIMES_16(DO, n) DO(n##0) DO(n##1) DO(n##2) DO(n##3) DO(n##4) DO(n##5) DO(n##6) DO(n##7) \
                        DO(n##8) DO(n##9) DO(n##a) DO(n##b) DO(n##c) DO(n##d) DO(n##e) DO(n##f)
#define TIMES_256(DO, n) TIMES_16(DO, n##0) TIMES_16(DO, n##1) TIMES_16(DO, n##2) TIMES_16(DO, n##3) \
                         TIMES_16(DO, n##4) TIMES_16(DO, n##5) TIMES_16(DO, n##6) TIMES_16(DO, n##7) \
                         TIMES_16(DO, n##8) TIMES_16(DO, n##9) TIMES_16(DO, n##a) TIMES_16(DO, n##b) \
                         TIMES_16(DO, n##c) TIMES_16(DO, n##d) TIMES_16(DO, n##e) TIMES_16(DO, n##f)
#define TIMES_SLOTS(DO) TIMES_256(DO, 0x0) TIMES_256(DO, 0x1) TIMES_256(DO, 0x2) TIMES_256(DO, 0x3)

#define DEFINE_CREATE(n) static void *create_##n(void) { return new_message(&types[n]); }
#define DEFINE_EVENT(n) static void *event_##n(const char *info, void *allocator, const struct live_message *request, \
                                               const struct live_message *response) \
  { (void)allocator; return new_event(&types[n], info, request, response); }
#define NAME_CREATE(n) create_##n,
#define NAME_EVENT(n) event_##n,

typedef void *(*create_function)(void);
typedef void *(*event_function)(const char *, void *, const struct live_message *, const struct live_message *);

TIMES_SLOTS(DEFINE_CREATE)
TIMES_SLOTS(DEFINE_EVENT)
static const create_function create_functions[SLOTS] = {TIMES_SLOTS(NAME_CREATE)};
static const event_function event_functions[SLOTS] = {TIMES_SLOTS(NAME_EVENT)};

/* A new type, or NULL when this copy of the library has no slot left. The caller keeps all arguments alive. */
struct live_type *live_new_type(const char *name, const uint32_t *program, size_t length, void *encode, void *decode)
{
  if (types_used == SLOTS) return NULL;
  struct live_type *type = &types[types_used++];
  *type = (struct live_type){name, false, program, length, encode, decode, NULL};
  return type;
}

create_function live_create_function(const struct live_type *type) { return create_functions[type - types]; }

/* ---------------------------------------------------------------- type supports */

struct description {                             /* in rosidl_runtime_c's own layout */
  const void *hash, *text, *sources;
};

struct message_support {                         /* rosidl_message_type_support_t */
  const char *identifier;
  const void *data;
  const void *(*find)(const struct message_support *, const char *);
  const void *(*get_hash)(const struct message_support *);
  const void *(*get_description)(const struct message_support *);
  const void *(*get_sources)(const struct message_support *);
  struct description described;                  /* from here on ours */
  const struct message_support *introspection;
};

static const void *message_find(const struct message_support *support, const char *identifier)
{
  if (strcmp(support->identifier, identifier) == 0) return support;
  return support->introspection ? message_find(support->introspection, identifier) : NULL;
}

static const void *message_hash(const struct message_support *support) { return support->described.hash; }
static const void *message_description(const struct message_support *support) { return support->described.text; }
static const void *message_sources(const struct message_support *support) { return support->described.sources; }

static struct message_support *new_message_support(const char *identifier, const void *data,
                                                   const struct description *described)
{
  struct message_support *support = calloc(1, sizeof *support);
  if (support)
    *support = (struct message_support){identifier, data, message_find, message_hash, message_description,
                                        message_sources, *described, NULL};
  return support;
}

struct message_callbacks {                       /* rosidl_typesupport_fastrtps_c's message_type_support_callbacks_t */
  const char *package, *name;
  bool (*serialize)(const struct live_message *, void *);
  bool (*deserialize)(void *, struct live_message *);
  uint32_t (*serialized_size)(const struct live_message *);
  size_t (*max_serialized_size)(char *);
  const void *key_callbacks;
};

static const char *const FASTRTPS = "rosidl_typesupport_fastrtps_c";

/* Strings handed in here are kept, not copied; so is `introspection`. */
struct message_support *live_message_support(const char *package, const char *name, const struct description *described,
                                             const struct message_support *introspection)
{
  struct message_callbacks *callbacks = calloc(1, sizeof *callbacks);
  if (!callbacks) return NULL;
  *callbacks = (struct message_callbacks){package, name, live_serialize, live_deserialize, live_serialized_size,
                                          live_max_serialized_size, NULL};
  struct message_support *support = new_message_support(FASTRTPS, callbacks, described);
  if (support) support->introspection = introspection;
  return support;
}

struct member {                                  /* rosidl_typesupport_introspection_c__MessageMember */
  const char *name;
  uint8_t type;
  size_t string_bound;
  const struct message_support *nested;
  bool is_key, is_array;
  size_t array_size;
  bool is_upper_bound;
  uint32_t offset;
  const void *default_value, *functions[6];
};

struct members {                                 /* rosidl_typesupport_introspection_c__MessageMembers */
  const char *package, *name;
  uint32_t count;
  size_t size_of;
  bool has_key;
  const struct member *members;
  const void *init, *fini;
};

struct member *live_new_members(size_t count) { return calloc(count, sizeof(struct member)); }

void live_set_member(struct member *members, size_t index, const char *name, uint8_t type, size_t string_bound,
                     const struct message_support *nested, bool is_array, size_t array_size, bool is_upper_bound)
{
  members[index] = (struct member){.name = name, .type = type, .string_bound = string_bound, .nested = nested,
                                   .is_array = is_array, .array_size = array_size, .is_upper_bound = is_upper_bound};
}

/* What rmw_fastrtps describes a topic's type with; names and types are all it reads. */
struct message_support *live_introspection(const char *identifier, const char *package, const char *name,
                                           const struct member *members, uint32_t count,
                                           const struct description *described)
{
  struct members *all = calloc(1, sizeof *all);
  if (!all) return NULL;
  *all = (struct members){.package = package, .name = name, .count = count,
                          .size_of = sizeof(struct live_message), .members = members};
  return new_message_support(identifier, all, described);
}

struct service_support {                         /* rosidl_service_type_support_t */
  const char *identifier;
  const void *data;
  const void *(*find)(const struct service_support *, const char *);
  const struct message_support *request, *response, *event;
  event_function event_create;
  bool (*event_destroy)(struct live_message *, void *);
  const void *(*get_hash)(const struct service_support *);
  const void *(*get_description)(const struct service_support *);
  const void *(*get_sources)(const struct service_support *);
  struct description described;                  /* from here on ours */
};

static const void *service_find(const struct service_support *support, const char *identifier)
{
  return strcmp(support->identifier, identifier) == 0 ? support : NULL;
}

static const void *service_hash(const struct service_support *support) { return support->described.hash; }
static const void *service_description(const struct service_support *support) { return support->described.text; }
static const void *service_sources(const struct service_support *support) { return support->described.sources; }

struct service_callbacks {                       /* rosidl_typesupport_fastrtps_c's service_type_support_callbacks_t */
  const char *package, *name;
  const struct message_support *request, *response;
};

struct service_support *live_service_support(const char *package, const char *name,
                                             const struct message_support *request,
                                             const struct message_support *response,
                                             const struct message_support *event, struct live_type *event_type,
                                             void *make_event, const struct description *described)
{
  struct service_callbacks *callbacks = calloc(1, sizeof *callbacks);
  struct service_support *support = calloc(1, sizeof *support);
  if (!callbacks || !support) return NULL;
  *callbacks = (struct service_callbacks){package, name, request, response};
  event_type->make_event = make_event;
  *support = (struct service_support){FASTRTPS, callbacks, service_find, request, response, event,
                                      event_functions[event_type - types], live_destroy_event,
                                      service_hash, service_description, service_sources, *described};
  return support;
}

struct action_support {                          /* rosidl_action_type_support_t */
  const void *goal_service, *result_service, *cancel_service, *feedback_message, *status_message;
  const void *(*get_hash)(const struct action_support *);
  const void *(*get_description)(const struct action_support *);
  const void *(*get_sources)(const struct action_support *);
  struct description described;                  /* from here on ours */
};

static const void *action_hash(const struct action_support *support) { return support->described.hash; }
static const void *action_description(const struct action_support *support) { return support->described.text; }
static const void *action_sources(const struct action_support *support) { return support->described.sources; }

struct action_support *live_action_support(const void *goal, const void *result, const void *cancel,
                                           const void *feedback, const void *status,
                                           const struct description *described)
{
  struct action_support *support = calloc(1, sizeof *support);
  if (support)
    *support = (struct action_support){goal, result, cancel, feedback, status,
                                       action_hash, action_description, action_sources, *described};
  return support;
}
