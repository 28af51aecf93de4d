/*
 * Whoever leaves the graph waits for the discovery callback that may be running: rmw_fastrtps's destroy_participant calls
 * set_listener(nullptr), which waits for ever. The ROS wheels are built for a glibc without pthread_cond_clockwait; there
 * libstdc++ converts that end of time to another clock, which overflows. The wait fails at once and is tried again, and
 * the mutex that the callback wants is never free: the process computes and never ends (12 of 8500 on a busy machine).
 *
 * This library is loaded before rmw_fastrtps, for all to see (RTLD_GLOBAL, see autoload.py). So rmw_fastrtps finds this
 * function first, which is the same with an end: Fast DDS has one that is given seconds.
 */
#define _GNU_SOURCE
#include <dlfcn.h>

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
