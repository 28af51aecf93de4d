/*
 * Two repairs of rmw_fastrtps for what happens when a process leaves the graph. This library is loaded before it, for
 * all to see (RTLD_GLOBAL, see autoload.py), so it finds the functions below first.
 *
 * 1. Whoever leaves the graph waits for the discovery callback that may be running: rmw_fastrtps's
 *    destroy_participant calls set_listener(nullptr), which waits for ever. The ROS wheels are built for a glibc without
 *    pthread_cond_clockwait; there libstdc++ converts that end of time to another clock, which overflows. The wait fails
 *    at once and is tried again, and the mutex that the callback wants is never free: the process computes and never
 *    ends (12 of 8500 on a busy machine).
 *    The function below is the same with an end: Fast DDS has one that is given seconds.
 *
 * 2. Whoever stays learns in one thread that a participant has left, and reads in another which nodes it has. Where the
 *    last of these messages is read after the leaving, it brings the nodes back for ever (10 of 400 programs that
 *    Ctrl-C had ended). So a message of a participant that has left, and has not come again, is not heeded.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <pthread.h>
#include <stdbool.h>
#include <string.h>

#define JAZZYS "libfastrtps.so.2.14"
#define KILTEDS "libfastdds.so.3.2"
#define WITHIN "_ZN8eprosima7fastdds3dds17DomainParticipant12set_listenerEPNS1_25DomainParticipantListenerENSt6chrono8durationIlSt5ratioILl1ELl1EEEE"
#define AN_HOUR 3600L
#define FAILED 1u /* ReturnCode_t::RETCODE_ERROR */

unsigned _ZN8eprosima7fastdds3dds17DomainParticipant12set_listenerEPNS1_25DomainParticipantListenerE(
    void *participant, void *listener)
{
    void *jazzys = dlopen(JAZZYS, RTLD_LAZY | RTLD_NOLOAD);
    void *library = jazzys ? jazzys : dlopen(KILTEDS, RTLD_LAZY | RTLD_NOLOAD);
    unsigned (*set_listener)(void *, void *, long) = 0;
    if (library)
        *(void **)&set_listener = dlsym(library, WITHIN);
    return set_listener ? set_listener(participant, listener, AN_HOUR) : FAILED;
}

#define GRAPH "librmw_dds_common.so"
#define ADD "_ZN14rmw_dds_common10GraphCache15add_participantERK9rmw_gid_sRKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE"
#define REMOVE "_ZN14rmw_dds_common10GraphCache18remove_participantERK9rmw_gid_s"
#define UPDATE "_ZN14rmw_dds_common10GraphCache27update_participant_entitiesERKNS_3msg24ParticipantEntitiesInfo_ISaIvEEE"
#define REMEMBERED 256 /* a message is late by moments */

struct gid {                    /* rmw_gid_t */
  const char *implementation;
  unsigned char data[16];
};

struct leaver {                 /* a participant, and the graph that it has left: each context has its own */
  void *graph;
  unsigned char gid[16];
};

struct leaver leavers[REMEMBERED]; /* for all to see: a test reads it */
static unsigned next_leaver;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static struct leaver *find_leaver(void *graph, const unsigned char *gid)
{
  for (struct leaver *each = leavers; each < leavers + REMEMBERED; each++)
    if (each->graph == graph && memcmp(each->gid, gid, sizeof each->gid) == 0)
      return each;
  return 0;
}

static void *find_function(const char *name)
{
  void *library = dlopen(GRAPH, RTLD_LAZY | RTLD_NOLOAD);
  return library ? dlsym(library, name) : 0;
}

bool remove_participant(void *graph, const struct gid *gid) __asm__(REMOVE);
bool remove_participant(void *graph, const struct gid *gid)
{
  bool (*remove)(void *, const struct gid *) = 0;
  *(void **)&remove = find_function(REMOVE);
  pthread_mutex_lock(&lock);
  struct leaver *leaver = &leavers[next_leaver++ % REMEMBERED];
  leaver->graph = graph;
  memcpy(leaver->gid, gid->data, sizeof leaver->gid);
  bool removed = remove && remove(graph, gid);
  pthread_mutex_unlock(&lock);
  return removed;
}

void add_participant(void *graph, const struct gid *gid, const void *enclave) __asm__(ADD);
void add_participant(void *graph, const struct gid *gid, const void *enclave)
{
  void (*add)(void *, const struct gid *, const void *) = 0;
  *(void **)&add = find_function(ADD);
  pthread_mutex_lock(&lock);
  for (struct leaver *before; (before = find_leaver(graph, gid->data));)
    before->graph = 0;
  if (add)
    add(graph, gid, enclave);
  pthread_mutex_unlock(&lock);
}

void update_participant(void *graph, const unsigned char *message) __asm__(UPDATE); /* which begins with its gid */
void update_participant(void *graph, const unsigned char *message)
{
  void (*update)(void *, const unsigned char *) = 0;
  *(void **)&update = find_function(UPDATE);
  pthread_mutex_lock(&lock);
  if (update && !find_leaver(graph, message))
    update(graph, message);
  pthread_mutex_unlock(&lock);
}
